"""What people type for a part of a robot finds the right entry first, the words of shared/robots and others alike."""

from tests.cases import each_case

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
    "absolute encoder": "encoder_optical", "worm gear": "worm_gear", "suction cup": "suction_cup",
    "power supply": "power_supply", "relay": "relay", "light curtain": "light_curtain", "load cell": "load_cell",
    "rubber track": "rubber_track", "telemetry radio": "rc_receiver", "laser scanner": "lidar_2d",
}  # fmt: skip


MORE = {
    "LiDAR": "lidar_2d", "3D lidar": "lidar_3d", "solid state lidar": "lidar_3d_solid_state", "Velodyne": "lidar_3d",
    "safety laser scanner": "safety_laser_scanner", "stereo camera": "depth_camera", "RGB-D camera": "depth_camera",
    "RealSense": "depth_camera", "depth sensor": "depth_camera", "webcam": "camera", "time of flight sensor":
    "time_of_flight_sensor", "IMU sensor": "imu", "gyroscope": "imu", "AHRS": "imu", "compass": "magnetometer",
    "RTK GPS": "gnss_receiver", "GNSS antenna": "antenna", "servo motor": "servo_motor", "Dynamixel": "smart_servo",
    "rotary actuator": "smart_servo", "joint module": "smart_servo", "DC motor": "brushed_dc_motor",
    "gear motor": "gearmotor", "drive unit": "gearmotor", "in-wheel motor": "bldc_motor", "drone motor": "drone_motor",
    "servo drive": "servo_drive", "motor controller": "motor_controller", "stepper driver": "motor_driver",
    "VESC": "motor_controller", "speed controller": "esc", "strain wave gear": "strain_wave_gear",
    "cycloidal drive": "cycloidal_gear", "gear reducer": "planetary_gearbox", "worm gearbox": "worm_gear",
    "bevel gear": "spur_gear", "ball bearing": "ball_bearing", "cross roller bearing": "roller_bearing",
    "bushing": "plain_bearing", "rod end": "plain_bearing", "shaft": "shaft", "axle": "shaft",
    "shaft coupling": "coupling", "pulley": "pulley", "V-belt": "v_belt", "chain": "chain", "sprocket": "chain",
    "linear guide": "linear_rail", "linear actuator": "linear_actuator", "linear stage": "linear_actuator",
    "rotary encoder": "encoder_optical", "hall sensor": "encoder_magnetic", "resolver": "resolver",
    "current sensor": "current_sensor", "thermocouple": "temperature_sensor",
    "proximity sensor": "inductive_sensor", "water leak sensor": "leak_sensor", "smoke detector": "smoke_sensor",
    "color sensor": "line_sensor", "pressure switch": "pressure_sensor", "BMS": "bms", "18650": "battery_li_ion",
    "LiFePO4 battery": "battery_lfp", "lead acid battery": "battery_lead_acid", "charging dock": "charger",
    "charge controller": "charger", "power distribution board": "power_distribution", "PDB": "power_distribution",
    "PDU": "power_distribution", "UPS": "ups", "uninterruptible power supply": "ups", "DC-DC": "dc_dc_converter",
    "buck converter": "dc_dc_converter", "voltage regulator": "dc_dc_converter", "AC adapter": "power_supply",
    "fuse": "fuse", "circuit breaker": "circuit_breaker", "contactor": "contactor", "SSR": "solid_state_relay",
    "safety relay": "safety_relay", "safety PLC": "safety_controller", "PLC": "plc", "e-stop": "emergency_stop",
    "deadman switch": "enabling_switch", "micro switch": "bumper_switch", "safety mat": "safety_bumper",
    "key switch": "push_button", "Arduino": "microcontroller_board", "STM32": "microcontroller_board",
    "FPGA": "fpga", "NUC": "mini_pc", "industrial PC": "industrial_pc", "Pixhawk": "flight_controller",
    "hard drive": "hard_disk", "NVMe": "ssd", "SD card": "sd_card",
    "network switch": "ethernet_switch", "WiFi module": "wifi_module", "4G modem": "lte_modem", "USB hub": "usb_hub",
    "EtherCAT": "bus_interface", "RFID reader": "rfid_reader", "remote controller": "remote_control",
    "touchscreen": "touch_screen", "status LED": "led", "buzzer": "speaker", "parallel gripper": "gripper_electric",
    "pneumatic cylinder": "pneumatic_cylinder", "air compressor": "air_compressor", "air hose": "hose",
    "hydraulic hose": "hose", "hydraulic cylinder": "hydraulic_cylinder", "vacuum generator": "vacuum_ejector",
    "motor brake": "holding_brake", "shock absorber": "shock_absorber", "gas spring": "gas_spring",
    "o-ring": "seal_static", "drive wheel": "drive_wheel", "omni wheel": "omni_wheel", "tire": "pneumatic_tyre",
    "energy chain": "drag_chain_cable", "wiring harness": "robot_cable_harness", "XT60": "connector_power",
    "RJ45": "connector_ethernet", "heatsink": "heat_sink", "rotor blade": "propeller", "chassis": "structural_frame",
    "screw": "fastener",
}  # fmt: skip
"""A second list, of all that a roboticist may ask for."""


def test_nine_of_ten_of_the_shared_words_are_found_first(shared):
    words = (shared / "robots" / "words.txt").read_text().split("\n")
    asked = [word for word in words if word.strip()]
    assert set(asked) == set(SHARED)
    right = [word for word in asked if [entry.name for entry in search(word)][:1] == [SHARED[word]]]
    assert len(right) >= 0.9 * len(asked), sorted(set(asked) - set(right))


@each_case("word", [*OTHERS, *MORE])
def test_others_are_found_first_too(word):
    assert [entry.name for entry in search(word)][:1] == [(OTHERS | MORE)[word]]
