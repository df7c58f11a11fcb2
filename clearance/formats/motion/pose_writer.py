"""A pose table to a file that `requests` reads back: CSV, or stamped poses in YAML or JSON.

Every number is written so that it comes back bit for bit, quaternions as their file had them; times of messages
are whole nanoseconds. What would not come back is refused. Not for: reading (`tables`, `pose_messages`).
"""

from __future__ import annotations

import io
import json
from typing import Any

from clearance.errors import BadMotion, ClearanceError
from clearance.formats.known_formats import Kind, function_at, written_as
from clearance.formats.message.values import NANO, whole_times
from clearance.formats.motion.requests import PoseRequest, PoseSamples, read_samples
from clearance.formats.motion.trajectory_writer import WrittenFile, table_text
from clearance.formats.text.file_start import POSE_COLUMNS
from clearance.formats.text.yaml_text import flow
from clearance.world.pose_table import WORLD_FRAMES

Message = dict[str, Any]


def written_poses(samples: PoseSamples, shown: str) -> WrittenFile:
    """The content of the file `shown`, in the format of its suffix.

    Messages are a Path, or transforms where the samples are of a frame of their own.

    Args:
        shown: with one of the suffixes that are written.

    Raises:
        BadInput: too much for the format; in a table, poses of a frame that may move. BadTime: samples less than a
            nanosecond apart.
    """
    known = written_as(Kind.POSES, shown)
    if samples.frame not in ("", *WORLD_FRAMES) and not known.is_message:
        raise BadMotion(
            f"the poses are in frame {samples.frame!r}, which a table cannot say",
            valid=f"a .yaml or .json file; in a case, with on: {samples.frame} if that is a link",
        )
    content = function_at(known.write)(samples).encode()
    if known.is_message:
        stamps = whole_times(samples.times.tolist())
        notes = [*_lost_in_messages(samples), *([stamps.note()] if stamps.n_rounded else [])]
    else:
        notes = _lost_in_tables(samples)
    _refuse_other(samples, content, shown)
    return WrittenFile(content, tuple(notes))


def csv_text(samples: PoseSamples) -> str:
    """A table: times, positions, quaternions."""
    columns = (samples.times[:, None], samples.positions, samples.quaternions)
    return table_text(POSE_COLUMNS, columns)


def yaml_text(samples: PoseSamples) -> str:
    """A line for each key of the message, and one for each pose."""
    lines = []
    for key, value in _message(samples).items():
        if isinstance(value, list):
            lines += [f"{key}:", *(f"- {flow(one)}" for one in value)]
        else:
            lines.append(f"{key}: {flow(value)}")
    return "\n".join([*lines, ""])


def json_text(samples: PoseSamples) -> str:
    """The same message in JSON."""
    return json.dumps(_message(samples), ensure_ascii=False) + "\n"


def _message(samples: PoseSamples) -> Message:
    """A Path; a TFMessage where the samples say of which frame they are."""
    key, place, turn = ("pose", "position", "orientation")
    if samples.child:
        key, place, turn = ("transform", "translation", "rotation")
    nanoseconds = whole_times(samples.times.tolist()).nanoseconds
    rows = zip(nanoseconds, samples.positions.tolist(), samples.quaternions.tolist(), strict=True)
    messages = [
        {
            "header": _header(samples.stamp + time, samples.frame),
            **({"child_frame_id": samples.child} if samples.child else {}),
            key: {
                place: dict(zip("xyz", position, strict=True)),
                turn: dict(zip("xyzw", quaternion, strict=True)),
            },
        }
        for time, position, quaternion in rows
    ]
    if samples.child:
        return {"transforms": messages}
    return {"header": messages[0]["header"], "poses": messages}


def _header(nanoseconds: int, frame: str) -> Message:
    seconds, rest = divmod(nanoseconds, NANO)
    return {"stamp": {"sec": seconds, "nanosec": rest}, "frame_id": frame}


def _lost_in_tables(samples: PoseSamples) -> list[str]:
    """The notes on what a table has no place for."""
    seen_from = [f"the poses are in frame {samples.frame!r}, which a table cannot say"]
    of = [f"the poses are those of frame {samples.child!r}, which a table cannot say"]
    return [*(seen_from if samples.frame else []), *(of if samples.child else [])]


def _lost_in_messages(samples: PoseSamples) -> list[str]:
    notes = []
    if not samples.frame:
        notes.append("frame_id is empty, since nothing says in which frame the poses are")
    first = samples.times[0].item()
    if first:
        notes.append(
            f"messages count from their first, here at {first} s: "
            f"moves: {{file: …, start: {first}}} keeps the times"
        )
    return notes


def _refuse_other(samples: PoseSamples, content: bytes, shown: str) -> None:
    """Nothing, if the file is read back as what was written."""
    try:
        back = read_samples(PoseRequest(lambda: io.BytesIO(content)), shown).samples
    except ClearanceError as error:
        raise BadMotion(f"the poses cannot be written as {shown!r}: {error}") from None
    same = back.positions.tobytes() == samples.positions.tobytes()
    same = same and back.quaternions.tobytes() == samples.quaternions.tobytes()
    if not same:
        raise BadMotion(f"the poses would be read otherwise from {shown!r}", valid="another format")
