//! Promises about faults that are injected by name: times of events, and the estimate beside the truth.

use board_tests::fault_rows::measure;

/// Checks that the firmware keeps the promise of a row.
fn assert_holds(row: &str) {
    let measured = measure(row);
    assert!(measured.holds, "{measured:#?}");
}

#[test]
fn an_imu_that_resets_is_back_with_another_zero_and_no_step() {
    assert_holds("imu_reset");
}

#[test]
fn an_imu_that_browns_out_is_back_with_another_zero_and_no_step() {
    assert_holds("imu_brown_out");
}

#[test]
fn an_imu_that_is_replugged_is_back_with_another_zero_and_no_step() {
    assert_holds("imu_replugged");
}

#[test]
fn a_heading_that_jumps_for_50_ms_leaves_no_step() {
    assert_holds("imu_short_jump");
}

#[test]
fn a_single_wrong_output_leaves_no_step() {
    assert_holds("imu_single_wrong");
}

#[test]
fn an_unplugged_imu_costs_the_others_no_reading_and_the_tip_stays() {
    assert_holds("imu_unplugged");
}

#[test]
fn a_frozen_imu_is_stuck_after_half_a_second_and_the_tip_stays() {
    assert_holds("imu_frozen");
}

#[test]
fn a_frozen_imu_is_stuck_within_a_second_in_slow_motion() {
    assert_holds("imu_frozen_slow");
}

#[test]
fn quaternions_of_zeros_are_never_used() {
    assert_holds("imu_zeros");
}

#[test]
fn quaternions_that_are_no_orientations_are_never_used() {
    assert_holds("imu_norm");
}

#[test]
fn a_silent_multiplexer_never_exchanges_imus() {
    assert_holds("mux_silent");
}

#[test]
fn a_stuck_multiplexer_never_exchanges_imus() {
    assert_holds("mux_stuck");
}

#[test]
fn a_multiplexer_on_the_wrong_channel_never_exchanges_imus() {
    assert_holds("mux_wrong");
}

#[test]
fn a_multiplexer_that_confirms_a_wrong_channel_never_exchanges_imus() {
    assert_holds("mux_lying");
}

#[test]
fn a_stopped_converter_costs_bend_sensors_and_no_tick() {
    assert_holds("adc_stopped");
}

#[test]
fn random_bytes_at_line_rate_cost_no_tick_and_the_arm_is_vented() {
    assert_holds("line_flood");
}

#[test]
fn a_host_that_is_gone_leaves_the_arm_vented() {
    assert_holds("line_cut");
}

#[test]
fn flipped_bits_of_the_stored_table_are_found_at_boot() {
    assert_holds("flash_flip");
}

#[test]
fn a_power_cut_leaves_the_arm_vented() {
    assert_holds("power_cut");
}

#[test]
fn a_tick_that_is_held_up_ends_in_a_reset_and_the_arm_is_vented() {
    assert_holds("tick_held");
}

#[test]
fn a_stack_overflow_ends_in_a_reset_and_the_arm_is_vented() {
    assert_holds("stack_overflow");
}

#[test]
fn an_open_bend_sensor_is_lost_alone_and_the_tip_stays() {
    assert_holds("bend_open");
}

#[test]
fn a_held_data_line_leaves_the_estimate_by_bend_sensors() {
    assert_holds("sda_held");
}

#[test]
fn a_shorted_bend_sensor_is_lost_alone_and_the_tip_stays() {
    assert_holds("bend_short");
}

#[test]
fn a_bend_sensor_that_comes_and_goes_is_reported() {
    assert_holds("bend_intermittent");
}

#[test]
fn a_bend_sensor_that_steps_is_named_within_a_second_and_the_tip_stays() {
    assert_holds("bend_offset");
}

#[test]
fn a_heading_that_jumps_is_reported_within_30_ms_and_leaves_no_step() {
    assert_holds("imu_jump");
}

#[test]
fn an_imu_that_refuses_some_polls_costs_the_others_nothing() {
    assert_holds("imu_nack");
}

#[test]
fn wrong_tags_in_every_second_scan_are_reported() {
    assert_holds("adc_tags_every_other");
}

#[test]
fn bytes_that_arrive_again_three_seconds_later_move_nothing() {
    assert_holds("line_replay");
}

#[test]
fn a_disarm_that_arrives_behind_a_later_request_vents() {
    assert_holds("line_reorder");
}

#[test]
fn a_bend_sensor_that_drifts_is_named_and_the_tip_stays() {
    assert_holds("bend_drift");
}

#[test]
fn a_bend_sensor_with_another_scale_is_named_within_a_second_and_the_tip_stays() {
    assert_holds("bend_factor");
}

#[test]
fn a_last_segment_without_any_sensor_is_not_known() {
    assert_holds("last_segment_lost");
}

#[test]
fn another_segment_without_any_sensor_follows_from_the_next_one() {
    assert_holds("segment_lost");
}
