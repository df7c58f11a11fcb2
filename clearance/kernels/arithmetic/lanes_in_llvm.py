"""What the compiler makes of `lanes`: one register of four numbers, and LLVM's instructions on it.

It is imported when something is compiled. Not for: what these functions mean (`lanes`).
"""

import operator

from llvmlite import ir
from numba import types
from numba.extending import intrinsic, lower_builtin, models, register_model, type_callable

from clearance.compile.intrinsics import elements_at, llvm_function, stands_for
from clearance.kernels.arithmetic.width import WIDTH

_VECTOR = ir.VectorType(ir.DoubleType(), WIDTH)
_SINGLE = ir.VectorType(ir.FloatType(), WIDTH)
_PLACES = ir.VectorType(ir.IntType(32), WIDTH)


class LanesType(types.Type):
    """The compiler's type of four float64."""

    def __init__(self) -> None:
        super().__init__(name="Lanes")


_lanes = LanesType()


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, _VECTOR)


def _is_number(kind):
    return isinstance(kind, LanesType | types.Float)


def _vector(builder, kind, value):
    """The operand in all lanes."""
    if isinstance(kind, LanesType):
        return value
    if kind.bitwidth != 64:
        value = builder.fpext(value, ir.DoubleType())
    first = builder.insert_element(ir.Constant(_VECTOR, ir.Undefined), value, ir.IntType(32)(0))
    return builder.shuffle_vector(first, first, ir.Constant(_PLACES, [0] * WIDTH))


def _binary(function, instruction):
    @type_callable(function)
    def typer(context):
        def of(a, b):
            if _is_number(a) and _is_number(b) and (a is _lanes or b is _lanes):
                return _lanes
            return None

        return of

    def emit(context, builder, signature, values):
        a, b = (_vector(builder, *each) for each in zip(signature.args, values, strict=True))
        return getattr(builder, instruction)(a, b)

    for kinds in ((LanesType, LanesType), (LanesType, types.Float), (types.Float, LanesType)):
        lower_builtin(function, *kinds)(emit)


for _function, _instruction in (
    (operator.add, "fadd"), (operator.sub, "fsub"), (operator.mul, "fmul"), (operator.truediv, "fdiv"),
):  # fmt: skip
    _binary(_function, _instruction)


@type_callable(abs)
def _type_abs(context):
    return lambda a: _lanes if a is _lanes else None


@lower_builtin(abs, LanesType)
def _lower_abs(context, builder, signature, values):
    return _each(builder, "llvm.fabs", values[0])


def _each(builder, name, value):
    """A function of LLVM's of one number, or of each lane."""
    suffix = f"v{WIDTH}f64" if value.type == _VECTOR else "f64"
    kind = ir.FunctionType(value.type, [value.type])
    return builder.call(llvm_function(builder, f"{name}.{suffix}", kind), [value])


def _alike(builder, signature, values):
    """The operands, all in lanes if any is."""
    if signature.return_type is not _lanes:
        return values
    return [_vector(builder, *each) for each in zip(signature.args, values, strict=True)]


@intrinsic
def square_root(typing_context, a):
    def emit(context, builder, signature, values):
        return _each(builder, "llvm.sqrt", values[0])

    return a(a), emit


@intrinsic
def larger(typing_context, a, b):
    def emit(context, builder, signature, values):
        a, b = _alike(builder, signature, values)
        return builder.select(builder.fcmp_ordered(">", a, b), a, b)

    return (_lanes if _lanes in (a, b) else types.float64)(a, b), emit


@intrinsic
def where_positive(typing_context, test, a, b):
    def emit(context, builder, signature, values):
        test, a, b = _alike(builder, signature, values)
        return builder.select(builder.fcmp_ordered(">", test, ir.Constant(test.type, None)), a, b)

    return (_lanes if _lanes in (test, a, b) else types.float64)(test, a, b), emit


@intrinsic
def lanes_of(typing_context, a, b, c, d):
    def emit(context, builder, signature, values):
        vector = ir.Constant(_VECTOR, ir.Undefined)
        for place, value in enumerate(values):
            vector = builder.insert_element(vector, value, ir.IntType(32)(place))
        return vector

    number = types.float64
    return _lanes(number, number, number, number), emit


@intrinsic
def lanes_at(typing_context, array, row):
    def emit(context, builder, signature, values):
        kind = signature.args[0]
        index = builder.mul(values[1], values[1].type(WIDTH))
        (place,) = elements_at(context, builder, kind, values[0], [index])
        bits = kind.dtype.bitwidth
        vector = _VECTOR if bits == 64 else _SINGLE
        loaded = builder.load(builder.bitcast(place, vector.as_pointer()), align=bits // 8)
        return loaded if bits == 64 else builder.fpext(loaded, _VECTOR)

    return _lanes(array, types.intp), emit


@intrinsic
def number_at(typing_context, array, row, place):
    def emit(context, builder, signature, values):
        index = builder.add(builder.mul(values[1], values[1].type(WIDTH)), values[2])
        (place,) = elements_at(context, builder, signature.args[0], values[0], [index])
        number = builder.load(place)
        return number if number.type == ir.DoubleType() else builder.fpext(number, ir.DoubleType())

    return types.float64(array, types.intp, types.intp), emit


@intrinsic
def marks_within(typing_context, lanes, most):
    def emit(context, builder, signature, values):
        lanes, most = (_vector(builder, *each) for each in zip(signature.args, values, strict=True))
        within = builder.fcmp_ordered("<=", lanes, most)
        return builder.zext(builder.bitcast(within, ir.IntType(WIDTH)), ir.IntType(64))

    return types.int64(lanes, types.float64), emit


@intrinsic
def first_of(typing_context, marks):
    def emit(context, builder, signature, values):
        return builder.cttz(values[0], ir.IntType(1)(1))

    return types.int64(types.int64), emit


@intrinsic
def lane(typing_context, lanes, place):
    def emit(context, builder, signature, values):
        return builder.extract_element(values[0], values[1])

    return types.float64(lanes, types.intp), emit


def stand_for(functions):
    """Puts these in the places of the functions of these names, which Python runs."""
    for function in (
        square_root, larger, where_positive, lanes_of, lanes_at, number_at, marks_within, first_of, lane,
    ):  # fmt: skip
        stands_for(functions[function.__name__], function)
