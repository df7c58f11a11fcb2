"""The memory that kernels take for their temporaries: one stack a thread, given back when a kernel returns.

Written in LLVM's language, so that the library needs nothing but the system. A stack is a chain of chunks, each as
large as all before it together; most threads never have a second one. Kernels count no references: whatever they
make lives until they return, or until Python has copied their result.
"""

from __future__ import annotations

import sys

_GET, _SET = (
    ("TlsGetValue", "TlsSetValue")
    if sys.platform == "win32"
    else ("pthread_getspecific", "pthread_setspecific")
)

_OPEN = (
    """
declare i32 @TlsAlloc()
define void @clearance_open_memory() {
  %was_open = load i1, ptr @is_open
  br i1 %was_open, label %done, label %open
open:
  %key = call i32 @TlsAlloc()
  store i32 %key, ptr @key
  store i1 true, ptr @is_open
  br label %done
done:
  ret void
}
"""
    if sys.platform == "win32"
    else """
declare i32 @pthread_key_create(ptr, ptr)
define void @clearance_open_memory() {
  %was_open = load i1, ptr @is_open
  br i1 %was_open, label %done, label %open
open:
  %created = call i32 @pthread_key_create(ptr @key, ptr @free_all)
  store i1 true, ptr @is_open
  br label %done
done:
  ret void
}
"""
)

FIRST_CHUNK = 1 << 20
"""[bytes] of a thread's stack, as long as that is enough."""

SOURCE = f"""
; a stack: chunk, place of the next byte, end of the chunk
%stack = type {{ ptr, ptr, ptr }}
; a chunk begins with the chunk before it, and its size
%chunk = type {{ ptr, i64 }}

@key = internal global i32 0
@is_open = internal global i1 false
declare ptr @{_GET}(i32)
declare i32 @{_SET}(i32, ptr)
declare ptr @malloc(i64)
declare void @free(ptr)
declare void @abort()
{_OPEN}
define internal ptr @stack() {{
  %key = load i32, ptr @key
  %found = call ptr @{_GET}(i32 %key)
  %is_new = icmp eq ptr %found, null
  br i1 %is_new, label %make, label %give
make:
  %made = call ptr @malloc(i64 24)
  %failed = icmp eq ptr %made, null
  br i1 %failed, label %stop, label %fill
stop:
  call void @abort()
  unreachable
fill:
  store %stack zeroinitializer, ptr %made
  %kept = call i32 @{_SET}(i32 %key, ptr %made)
  call void @add_chunk(ptr %made, i64 {FIRST_CHUNK})
  ret ptr %made
give:
  ret ptr %found
}}

define internal void @add_chunk(ptr %stack, i64 %size) {{
  %made = call ptr @malloc(i64 %size)
  %failed = icmp eq ptr %made, null
  br i1 %failed, label %stop, label %fill
stop:
  call void @abort()
  unreachable
fill:
  %before = load ptr, ptr %stack
  store ptr %before, ptr %made
  %size_at = getelementptr %chunk, ptr %made, i32 0, i32 1
  store i64 %size, ptr %size_at
  store ptr %made, ptr %stack
  %next_at = getelementptr %stack, ptr %stack, i32 0, i32 1
  %first = getelementptr i8, ptr %made, i64 64
  store ptr %first, ptr %next_at
  %end_at = getelementptr %stack, ptr %stack, i32 0, i32 2
  %end = getelementptr i8, ptr %made, i64 %size
  store ptr %end, ptr %end_at
  ret void
}}

define ptr @clearance_take(i64 %asked) {{
  %stack = call ptr @stack()
  %more = add i64 %asked, 63
  %size = and i64 %more, -64
  %next_at = getelementptr %stack, ptr %stack, i32 0, i32 1
  %end_at = getelementptr %stack, ptr %stack, i32 0, i32 2
  %next = load ptr, ptr %next_at
  %end = load ptr, ptr %end_at
  %next_word = ptrtoint ptr %next to i64
  %end_word = ptrtoint ptr %end to i64
  %aligned_more = add i64 %next_word, 63
  %aligned = and i64 %aligned_more, -64
  %after = add i64 %aligned, %size
  %fits = icmp ule i64 %after, %end_word
  br i1 %fits, label %take, label %grow
take:
  %taken = inttoptr i64 %aligned to ptr
  %after_at = inttoptr i64 %after to ptr
  store ptr %after_at, ptr %next_at
  ret ptr %taken
grow:
  %chunk = load ptr, ptr %stack
  %size_at = getelementptr %chunk, ptr %chunk, i32 0, i32 1
  %last_size = load i64, ptr %size_at
  %twice = mul i64 %last_size, 2
  %needed = add i64 %size, 128
  %is_larger = icmp ugt i64 %needed, %twice
  %new_size = select i1 %is_larger, i64 %needed, i64 %twice
  call void @add_chunk(ptr %stack, i64 %new_size)
  %again = call ptr @clearance_take(i64 %asked)
  ret ptr %again
}}

define ptr @clearance_mark_memory() {{
  %stack = call ptr @stack()
  %next_at = getelementptr %stack, ptr %stack, i32 0, i32 1
  %next = load ptr, ptr %next_at
  ret ptr %next
}}

define void @clearance_release_memory(ptr %mark) {{
  %stack = call ptr @stack()
  %mark_word = ptrtoint ptr %mark to i64
  br label %look
look:
  %chunk = load ptr, ptr %stack
  %size_at = getelementptr %chunk, ptr %chunk, i32 0, i32 1
  %size = load i64, ptr %size_at
  %first_word = ptrtoint ptr %chunk to i64
  %end_word = add i64 %first_word, %size
  %is_above = icmp ugt i64 %mark_word, %first_word
  %is_below = icmp ule i64 %mark_word, %end_word
  %is_here = and i1 %is_above, %is_below
  %end = inttoptr i64 %end_word to ptr
  br i1 %is_here, label %set, label %drop
drop:
  %before = load ptr, ptr %chunk
  store ptr %before, ptr %stack
  call void @free(ptr %chunk)
  br label %look
set:
  %next_at = getelementptr %stack, ptr %stack, i32 0, i32 1
  store ptr %mark, ptr %next_at
  %end_at = getelementptr %stack, ptr %stack, i32 0, i32 2
  store ptr %end, ptr %end_at
  ret void
}}

define void @clearance_free_memory() {{
  %stack = call ptr @stack()
  br label %look
look:
  %chunk = load ptr, ptr %stack
  %before = load ptr, ptr %chunk
  %is_first = icmp eq ptr %before, null
  %first = getelementptr i8, ptr %chunk, i64 64
  br i1 %is_first, label %set, label %drop
drop:
  store ptr %before, ptr %stack
  call void @free(ptr %chunk)
  br label %look
set:
  call void @clearance_release_memory(ptr %first)
  ret void
}}

define internal void @free_all(ptr %stack) {{
  %first = load ptr, ptr %stack
  br label %look
look:
  %chunk = phi ptr [ %first, %0 ], [ %before, %drop ]
  %is_none = icmp eq ptr %chunk, null
  br i1 %is_none, label %done, label %drop
drop:
  %before = load ptr, ptr %chunk
  call void @free(ptr %chunk)
  br label %look
done:
  call void @free(ptr %stack)
  ret void
}}
"""

OF_MEMORY = (
    "clearance_open_memory", "clearance_take", "clearance_mark_memory",
    "clearance_release_memory", "clearance_free_memory",
)  # fmt: skip
"""What the library has of these."""

INSTEAD_OF_COUNTS = """
define internal void @NRT_incref(ptr %counted) alwaysinline {
  ret void
}
define internal void @NRT_decref(ptr %counted) alwaysinline {
  ret void
}
define internal ptr @NRT_MemInfo_alloc_aligned(i64 %size, i32 %alignment) alwaysinline {
  %all = add i64 %size, 64
  %made = call ptr @clearance_take(i64 %all)
  %data = getelementptr i8, ptr %made, i64 64
  %data_at = getelementptr { i64, ptr, ptr, ptr, i64 }, ptr %made, i32 0, i32 3
  store ptr %data, ptr %data_at
  ret ptr %made
}
define internal ptr @NRT_MemInfo_alloc(i64 %size) alwaysinline {
  %made = call ptr @NRT_MemInfo_alloc_aligned(i64 %size, i32 64)
  ret ptr %made
}
define internal ptr @NRT_Allocate(i64 %size) alwaysinline {
  %made = call ptr @clearance_take(i64 %size)
  ret ptr %made
}
define internal void @NRT_Free(ptr %made) alwaysinline {
  ret void
}
define internal void @NRT_MemInfo_call_dtor(ptr %made) alwaysinline {
  ret void
}
define internal void @PyErr_SetString(ptr %kind, ptr %text) alwaysinline {
  ret void
}
define internal ptr @NRT_MemInfo_new_varsize_dtor(i64 %size, ptr %dtor) alwaysinline {
  %made = call ptr @NRT_MemInfo_alloc_aligned(i64 %size, i32 64)
  %size_at = getelementptr { i64, ptr, ptr, ptr, i64 }, ptr %made, i32 0, i32 4
  store i64 %size, ptr %size_at
  ret ptr %made
}
define internal ptr @NRT_MemInfo_varsize_realloc(ptr %made, i64 %size) alwaysinline {
  %data_at = getelementptr { i64, ptr, ptr, ptr, i64 }, ptr %made, i32 0, i32 3
  %size_at = getelementptr { i64, ptr, ptr, ptr, i64 }, ptr %made, i32 0, i32 4
  %before = load ptr, ptr %data_at
  %size_before = load i64, ptr %size_at
  %is_more = icmp ugt i64 %size, %size_before
  %kept = select i1 %is_more, i64 %size_before, i64 %size
  %data = call ptr @clearance_take(i64 %size)
  call void @llvm.memcpy.p0.p0.i64(ptr %data, ptr %before, i64 %kept, i1 false)
  store ptr %data, ptr %data_at
  store i64 %size, ptr %size_at
  ret ptr %data
}
define internal double @numba_frexp(double %number, ptr %exponent) alwaysinline {
  %found = call double @frexp(double %number, ptr %exponent)
  ret double %found
}
define internal double @numba_ldexp(double %number, i32 %exponent) alwaysinline {
  %found = call double @ldexp(double %number, i32 %exponent)
  ret double %found
}
define internal i32 @numba_attempt_nocopy_reshape(
    i64 %n, ptr %shape, ptr %strides, i64 %new_n, ptr %new_shape, ptr %new_strides, i64 %item, i32 %is_f) {
  br label %look
look:
  %k = phi i64 [ %n, %0 ], [ %axis, %next ]
  %size = phi i64 [ %item, %0 ], [ %after, %next ]
  %seen = icmp eq i64 %k, 0
  br i1 %seen, label %fill, label %check
check:
  %axis = sub i64 %k, 1
  %length_at = getelementptr i64, ptr %shape, i64 %axis
  %length = load i64, ptr %length_at
  %stride_at = getelementptr i64, ptr %strides, i64 %axis
  %stride = load i64, ptr %stride_at
  %is_next = icmp eq i64 %stride, %size
  %is_one = icmp eq i64 %length, 1
  %fits = or i1 %is_next, %is_one
  br i1 %fits, label %next, label %refuse
next:
  %after = mul i64 %size, %length
  br label %look
refuse:
  ret i32 0
fill:
  %j = phi i64 [ %new_n, %look ], [ %new_axis, %write ]
  %step = phi i64 [ %item, %look ], [ %more, %write ]
  %done = icmp eq i64 %j, 0
  br i1 %done, label %accept, label %write
write:
  %new_axis = sub i64 %j, 1
  %new_stride_at = getelementptr i64, ptr %new_strides, i64 %new_axis
  store i64 %step, ptr %new_stride_at
  %new_length_at = getelementptr i64, ptr %new_shape, i64 %new_axis
  %new_length = load i64, ptr %new_length_at
  %more = mul i64 %step, %new_length
  br label %fill
accept:
  ret i32 1
}
declare noalias nonnull ptr @clearance_take(i64)
declare double @frexp(double, ptr)
declare double @ldexp(double, i32)
declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)
"""
"""What numba's code calls for memory, reference counts and the text of exceptions: a stack, and nothing."""
