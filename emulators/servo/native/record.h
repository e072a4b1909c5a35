/* Written by emulators.servo.header from the tables in Python. Do not edit. */
#ifndef SERVO_RECORD_H
#define SERVO_RECORD_H
#include <stdint.h>

#define TICK INT64_C(100000)
#define TICKS_PER_MILLISECOND INT64_C(10)
#define IDLE INT64_C(0)
#define CURRENT INT64_C(1)
#define VELOCITY INT64_C(2)
#define POSITION INT64_C(3)
#define DIRECT INT64_C(0)
#define RAMP INT64_C(1)
#define MOVE INT64_C(2)
#define PROFILE_DONE INT64_C(1)
#define TARGET_REACHED INT64_C(2)
#define AT_REST INT64_C(4)
#define CURRENT_LIMITED INT64_C(8)
#define FOLLOWING_ERROR INT64_C(16)
#define OVER_CURRENT INT64_C(32)
#define UNDER_VOLTAGE INT64_C(64)
#define OVER_VOLTAGE INT64_C(128)
#define AVERAGE INT64_C(5)
#define WRAP INT64_C(4294967296)
#define HALF INT64_C(2147483648)
#define WIDEST_SPEED INT64_C(1073741824)
#define WIDEST_WAY INT64_C(68719476736)
#define VELOCITY_PLACES INT64_C(38)
#define POSITION_P_PLACES INT64_C(32)
#define POSITION_I_PLACES INT64_C(40)
#define POSITION_D_PLACES INT64_C(36)
#define SPEED_FORWARD_PLACES INT64_C(38)
#define ACCELERATION_FORWARD_PLACES INT64_C(32)
#define FILTER_PLACES INT64_C(16)
#define RESTING INT64_C(10)
#define LEARNING INT64_C(5000)
#define LEARNING_RATE INT64_C(838861)
#define BACK_EMF_PLACES INT64_C(24)
#define WIDEST_BACK_EMF INT64_C(4294967295)
#define FADED INT64_C(32)
#define CURRENT_PLACES INT64_C(8)
#define AVERAGE_PLACES INT64_C(16)
#define WIDEST_READING INT64_C(1073741824)
#define WIDEST_ANGLE INT64_C(4503599627370496)
#define WIDEST_STEP INT64_C(2147483648)

#define ENDED_REACHED 0
#define ENDED_TOLD 1
#define ENDED_CURRENT 2
#define ENDED_ANGLE 3
#define ENDED_SPEED 4
#define ENDED_SUPPLY 5
#define ENDED_WRITE 6
#define ENDED_STEP 7
#define ENDED_READ 8

typedef struct {
    int64_t encoder_resolution;
    int64_t supply_mv;
    int64_t analogue_1_mv;
    int64_t analogue_2_mv;
    int64_t resolution;
    int64_t fraction;
    int64_t current_p;
    int64_t current_i;
    int64_t velocity_p;
    int64_t velocity_i;
    int64_t velocity_speed_forward;
    int64_t velocity_acceleration_forward;
    int64_t position_p;
    int64_t position_i;
    int64_t position_d;
    int64_t position_filter;
    int64_t position_speed_forward;
    int64_t position_acceleration_forward;
    int64_t continuous_ma;
    int64_t peak_ma;
    int64_t thermal_full;
    int64_t speed_limit;
    int64_t following_limit_qc;
    int64_t position_window_qc;
    int64_t position_window_ms;
    int64_t velocity_window;
    int64_t velocity_window_ms;
    int64_t rest_window;
    int64_t rest_ms;
    int64_t voltage_percent;
    int64_t over_current_ma;
    int64_t under_voltage_mv;
    int64_t over_voltage_mv;
    int64_t powered;
    int64_t regulator;
    int64_t profile;
    int64_t current_setting_ma;
    int64_t target_velocity;
    int64_t target_position;
    int64_t cruise;
    int64_t acceleration;
    int64_t deceleration;
    int64_t stopping_distance;
    int64_t call;
    int64_t now;
    int64_t flags;
    int64_t encoder;
    int64_t position;
    int64_t step;
    int64_t velocity_average;
    int64_t current_ma;
    int64_t current_average;
    int64_t current_demand_ma;
    int64_t current_limit_ma;
    int64_t current_integral;
    int64_t voltage_mv;
    int64_t back_emf;
    int64_t turning;
    int64_t velocity_demand;
    int64_t acceleration_demand;
    int64_t position_demand;
    int64_t velocity_integral;
    int64_t position_integral;
    int64_t derivative;
    int64_t thermal;
    int64_t window_ms;
    int64_t still_ms;
    int64_t told;
} servo_axis;

typedef struct {
    int64_t fmi;
    void *component;
    void *write;
    void *forward;
    void *read;
    void *input_references;
    int64_t input_count;
    void *inputs;
    void *output_references;
    int64_t output_count;
    void *outputs;
    int64_t step_ns;
    int64_t steps_done;
} plant_calls;

typedef struct {
    int64_t count;
    void *axes;
    void *counts_per_radian;
    void *dividers;
    int64_t supply;
    int64_t sampled;
    void *plant;
    int64_t tick;
    int64_t fault_axis;
    int64_t fault_status;
    double fault_value;
} servo_bank;

#endif
