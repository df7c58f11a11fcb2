"""The functions of URScript: which are known, by what they do. Not for: doing it (`urscript`).

Source: Universal Robots, The URScript programming language.
"""

from __future__ import annotations

PARAMETERS = {
    "movej": ("q", "a", "v", "t", "r"),
    "movel": ("pose", "a", "v", "t", "r"),
    "movep": ("pose", "a", "v", "r"),
    "movec": ("pose_via", "pose_to", "a", "v", "r", "mode"),
}
TARGETS = ("q", "pose", "pose_via", "pose_to")
DEFAULTS = {"movej": (1.4, 1.05), "movel": (1.2, 0.25), "movep": (1.2, 0.25), "movec": (1.2, 0.25)}

OTHER_MOVES = frozenset(
    "servoj servoc servol speedj speedl force_mode freedrive_mode teach_mode run screw_driving "
    "track_conveyor_linear track_conveyor_circular path_offset_enable path_offset_set "
    "enable_external_ft_sensor jog start_jog move_until_contact optimovej optimovel".split()
)
STILL = frozenset(
    "textmsg varmsg popup sync stopj stopl stop_conveyor_tracking end_force_mode end_freedrive_mode "
    "end_teach_mode kill join enter_critical exit_critical zero_ftsensor powerdown protective_stop "
    "reset_revolution_counter encoder_enable_pulse_decode encoder_enable_set_tick_count end_screw_driving "
    "force to_str str_at str_cat str_empty str_find str_len str_sub to_num binary_list_to_integer "
    "integer_to_binary_list random make_list size struct".split()
)
BLOCKING = frozenset(
    "sleep sync join enter_critical socket_open socket_get_var powerdown protective_stop halt".split()
)
BLOCKING_BEFORE = ("request_", "socket_read_")
"""Functions that take time: until a person, a thread or another machine has answered."""

STILL_BEFORE = (
    *("set_", "get_", "read_", "write_", "is_", "socket_", "modbus_", "rtde_", "rpc_", "tool_"),
    *("request_", "assign_", "conveyor_", "xmlrpc", "enable_", "disable_"),
)
