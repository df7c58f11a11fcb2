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
    "enable_external_ft_sensor set_pos jog start_jog move_until_contact optimovej optimovel".split()
)
STILL = frozenset(
    "textmsg varmsg popup stopj stopl stop_conveyor_tracking end_force_mode end_freedrive_mode "
    "end_teach_mode kill exit_critical zero_ftsensor reset_revolution_counter encoder_enable_pulse_decode "
    "encoder_enable_set_tick_count end_screw_driving encoder_get_tick_count encoder_set_tick_count "
    "encoder_unwind_delta_tick_count conveyor_pulse_decode get_conveyor_tick_count set_conveyor_tick_count "
    "position_deviation_warning force to_str str_at str_cat str_empty str_find str_len str_sub to_num "
    "binary_list_to_integer integer_to_binary_list random make_list size struct get_list_length normalize "
    "interpolate_pose pose_dist pose_sub rotvec2rpy wrench_trans "
    # the arm and its load
    "get_actual_joint_positions get_actual_joint_positions_history get_actual_joint_speeds "
    "get_actual_tcp_pose get_actual_tcp_speed get_actual_tool_flange_pose get_controller_temp "
    "get_coriolis_and_centrifugal_torques get_forward_kin get_freedrive_status get_gravity get_inverse_kin "
    "get_inverse_kin_has_solution get_jacobian get_jacobian_time_derivative get_joint_positions "
    "get_joint_speeds get_joint_temp get_joint_torques get_mass_matrix get_robot_power get_steptime "
    "get_target_joint_positions get_target_joint_speeds get_target_payload get_target_payload_cog "
    "get_target_payload_inertia get_target_tcp_pose get_target_tcp_pose_along_path get_target_tcp_speed "
    "get_target_tcp_speed_along_path get_target_waypoint get_tcp_force get_tcp_offset get_tcp_power "
    "get_tcp_speed get_tool_accelerometer_reading get_tool_current is_steady is_within_safety_limits "
    "set_base_acceleration set_gravity set_payload set_payload_cog set_payload_mass set_speed "
    "set_safety_mode_transition_hardness set_target_payload tool_contact "
    # inputs and outputs
    "get_analog_in get_analog_out get_configurable_digital_in get_configurable_digital_out get_digital_in "
    "get_digital_out get_euromap_input get_euromap_output get_flag get_standard_analog_in "
    "get_standard_analog_out get_standard_digital_in get_standard_digital_out get_tool_analog_in "
    "get_tool_analog_out get_tool_digital_in get_tool_digital_out get_tool_digital_output_mode "
    "get_tool_output_mode set_analog_inputrange set_analog_out set_analog_outputdomain "
    "set_configurable_digital_input_action set_configurable_digital_out set_digital_out set_euromap_output "
    "set_euromap_runstate_dependent_choice set_flag set_gp_boolean_input_action "
    "set_input_actions_to_default set_runstate_configurable_digital_output_to_value "
    "set_runstate_gp_boolean_output_to_value set_runstate_standard_analog_output_to_value "
    "set_runstate_standard_digital_output_to_value set_runstate_tool_digital_output_to_value "
    "set_standard_analog_input_domain set_standard_analog_out set_standard_digital_input_action "
    "set_standard_digital_out set_tool_analog_input_domain set_tool_communication "
    "set_tool_digital_input_action set_tool_digital_out set_tool_digital_output_mode set_tool_output_mode "
    "set_tool_voltage read_port_bit read_port_register write_port_bit write_port_register "
    "read_input_boolean_register read_input_float_register read_input_integer_register "
    "read_output_boolean_register read_output_float_register read_output_integer_register "
    "write_output_boolean_register write_output_float_register write_output_integer_register "
    # other machines and people
    "modbus_add_signal modbus_delete_signal modbus_get_signal_status modbus_request_update_signal_value "
    "modbus_send_custom_command modbus_set_digital_input_action modbus_set_output_register "
    "modbus_set_output_signal modbus_set_runstate_dependent_choice modbus_set_signal_update_frequency "
    "rpc_factory rtde_set_watchdog socket_close socket_send_byte socket_send_int socket_send_line "
    "socket_send_string socket_set_var".split()
)
"""Further functions that move nothing, each by its name: houses and URCaps begin their own as the maker does."""

BLOCKING = frozenset(
    "sleep sync join enter_critical socket_open socket_get_var powerdown protective_stop halt "
    "socket_read_ascii_float socket_read_binary_integer socket_read_byte_list socket_read_line "
    "socket_read_string request_boolean_from_primary_client request_float_from_primary_client "
    "request_integer_from_primary_client request_string_from_primary_client".split()
)
"""Functions that take time: until a person, a thread or another machine has answered."""
