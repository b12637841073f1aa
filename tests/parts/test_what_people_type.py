"""What people type for a part of a robot finds the right entry first, the words of shared/robots and others alike."""

import pytest

from robophm.parts import search

SHARED = {
    "lidar": "lidar_2d", "depth camera": "depth_camera", "IMU": "imu", "GPS receiver": "gnss_receiver",
    "wheel encoder": "wheel_encoder", "harmonic drive": "strain_wave_gear", "planetary gearbox": "planetary_gearbox",
    "brushless motor": "bldc_motor", "servo": "hobby_servo", "ESC": "esc", "LiPo battery": "battery_lipo",
    "Raspberry Pi": "single_board_computer", "Jetson": "ai_computer_module", "flight controller": "flight_controller",
    "propeller": "propeller", "caster wheel": "caster_wheel", "timing belt": "timing_belt", "lead screw": "lead_screw",
    "linear rail": "linear_rail", "limit switch": "limit_switch", "emergency stop": "emergency_stop",
    "bumper switch": "bumper_switch", "ultrasonic sensor": "ultrasonic_sensor",
    "force torque sensor": "force_torque_sensor", "vacuum gripper": "suction_cup", "solenoid valve": "solenoid_valve",
    "cooling fan": "fan", "DC-DC converter": "dc_dc_converter", "battery management system": "bms",
    "slip ring": "slip_ring",
}  # fmt: skip

OTHERS = {
    "hub motor": "bldc_motor", "mecanum wheel": "omni_wheel", "battery charger": "charger", "thruster": "thruster",
    "wireless charging": "charger", "gimbal": "gimbal", "winch": "gearmotor", "potentiometer": "potentiometer",
    "joystick": "joystick", "teach pendant": "teach_pendant", "pressure sensor": "pressure_sensor",
    "barometer": "barometer", "hydraulic pump": "hydraulic_pump", "vacuum ejector": "vacuum_ejector",
    "pressure regulator": "pressure_regulator", "solar panel": "solar_panel", "supercapacitor": "supercapacitor",
    "GPU": "ai_computer_module", "heat sink": "heat_sink", "tool changer": "tool_changer", "gas sensor": "gas_sensor",
    "contact sensor": "bumper_switch", "reed switch": "limit_switch", "stepper motor": "stepper_motor",
    "ball screw": "ball_screw", "thermal camera": "thermal_camera", "SSD": "ssd", "CAN bus": "bus_interface",
    "absolute encoder": "encoder_optical", "worm gear": "spur_gear", "suction cup": "suction_cup",
    "power supply": "power_supply", "relay": "relay", "light curtain": "light_curtain", "load cell": "load_cell",
    "rubber track": "rubber_track", "telemetry radio": "rc_receiver", "laser scanner": "lidar_2d",
}  # fmt: skip


def test_nine_of_ten_of_the_shared_words_are_found_first(shared):
    words = (shared / "robots" / "words.txt").read_text().split("\n")
    asked = [word for word in words if word.strip()]
    assert set(asked) == set(SHARED)
    right = [word for word in asked if [entry.name for entry in search(word)][:1] == [SHARED[word]]]
    assert len(right) >= 0.9 * len(asked), sorted(set(asked) - set(right))


@pytest.mark.parametrize("word", OTHERS)
def test_others_are_found_first_too(word):
    assert [entry.name for entry in search(word)][:1] == [OTHERS[word]]
