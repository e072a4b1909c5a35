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
#define SPLINE INT64_C(3)
#define ELECTRONIC_GEAR INT64_C(4)
#define SINE INT64_C(1)
#define FASTEST_RPM INT64_C(25000)
#define PROFILE_DONE INT64_C(1)
#define TARGET_REACHED INT64_C(2)
#define AT_REST INT64_C(4)
#define CURRENT_LIMITED INT64_C(8)
#define FOLLOWING_ERROR INT64_C(16)
#define OVER_CURRENT INT64_C(32)
#define UNDER_VOLTAGE INT64_C(64)
#define OVER_VOLTAGE INT64_C(128)
#define CURRENT_REACHED INT64_C(256)
#define POSITION_LIMIT_PASSED INT64_C(65536)
#define OVER_TEMPERATURE INT64_C(131072)
#define LOGIC_SUPPLY_LOW INT64_C(262144)
#define GATE_SUPPLY_LOW INT64_C(524288)
#define ENCODER_BROKEN INT64_C(1048576)
#define INDEX_LOST INT64_C(2097152)
#define INDEX_DISTANCE_WRONG INT64_C(4194304)
#define HALL_IMPOSSIBLE INT64_C(8388608)
#define HALL_ANGLE_APART INT64_C(16777216)
#define ENCODER_AGAINST_MOTOR INT64_C(33554432)
#define AUXILIARY_AGAINST_MAIN INT64_C(67108864)
#define HEATING INT64_C(17)
#define HOTTEST_MC INT64_C(100000)
#define COOLED_MC INT64_C(5000)
#define LEAST_LOGIC_MV INT64_C(4500)
#define LEAST_GATE_MV INT64_C(9000)
#define BROKEN INT64_C(1)
#define SWAPPED INT64_C(2)
#define INDEX_MISSING INT64_C(4)
#define INDEX_SPURIOUS INT64_C(8)
#define AUXILIARY_SWAPPED INT64_C(16)
#define HALL_HIGH INT64_C(5)
#define HALL_LOW INT64_C(8)
#define HALL_LINES INT64_C(7)
#define HALL_SEQUENCE INT64_C(183449)
#define SECTORS INT64_C(6)
#define SPURIOUS_PART INT64_C(8)
#define INDEX_TOLERANCE INT64_C(7)
#define INDEX_SOONEST INT64_C(2)
#define INDEX_TURNS INT64_C(2)
#define PER_MILLE INT64_C(1000)
#define CONTRARY_MS INT64_C(20)
#define AVERAGE INT64_C(5)
#define WIDEST_SPEED INT64_C(1073741824)
#define WIDEST_WAY INT64_C(68719476736)
#define WRAP INT64_C(4294967296)
#define HALF INT64_C(2147483648)
#define DOWNWARDS INT64_C(1)
#define UPWARDS INT64_C(2)
#define MOVEMENT_START INT64_C(1)
#define INPUT_EDGE INT64_C(4)
#define MOVEMENT_END INT64_C(8)
#define VELOCITY_PLACES INT64_C(38)
#define POSITION_P_PLACES INT64_C(32)
#define POSITION_I_PLACES INT64_C(40)
#define POSITION_D_PLACES INT64_C(36)
#define SPEED_FORWARD_PLACES INT64_C(38)
#define ACCELERATION_FORWARD_PLACES INT64_C(32)
#define FILTER_PLACES INT64_C(16)
#define RESTING INT64_C(10)
#define LEARNING INT64_C(5000)
#define SLOWING INT64_C(16)
#define MOST_LEARNING INT64_C(268435456)
#define BACK_EMF_PLACES INT64_C(24)
#define WIDEST_BACK_EMF INT64_C(4294967295)
#define CURRENT_PLACES INT64_C(8)
#define RESISTANCE_PLACES INT64_C(16)
#define DIODES_MV INT64_C(1600)
#define DOUBTED_MA INT64_C(64)
#define FADED INT64_C(32)
#define SETTLING_MS INT64_C(1)
#define RECOVERING_MS INT64_C(3)
#define MOST_LEFT_MA INT64_C(1024)
#define JUST_OPENED INT64_C(2)
#define LEAST_LEARNING INT64_C(838861)
#define AVERAGE_PLACES INT64_C(16)
#define SHARE_PLACES INT64_C(31)
#define SINE_1 INT64_C(5298703516)
#define SINE_2 INT64_C(4358008962)
#define SINE_3 INT64_C(1433727481)
#define SINE_4 INT64_C(252684340)
#define SINE_5 INT64_C(27709939)
#define SINE_6 INT64_C(2071865)
#define SINE_7 INT64_C(112354)
#define MASTER INT64_C(65536)
#define ANALOGUE_1 INT64_C(131072)
#define ANALOGUE_2 INT64_C(262144)
#define FASTEST_INPUT INT64_C(2147483648)
#define WIDEST_VOLTAGE INT64_C(32767)
#define WIDEST_SETPOINT INT64_C(2147483647)
#define MILLISECONDS_PER_MINUTE INT64_C(60000)
#define CLOSED INT64_C(500)
#define WIDEST_READING INT64_C(1073741824)
#define WIDEST_ANGLE INT64_C(4503599627370496)
#define WIDEST_STEP INT64_C(2147483648)

#define ENDED_REACHED 0
#define ENDED_EVENT 1
#define ENDED_CURRENT 2
#define ENDED_ANGLE 3
#define ENDED_SPEED 4
#define ENDED_SUPPLY 5
#define ENDED_WRITE 6
#define ENDED_STEP 7
#define ENDED_READ 8
#define ENDED_PIN 9
#define ENDED_SENSOR 10

typedef struct {
    int64_t encoder_resolution;
    int64_t supply_mv;
    int64_t source_mv;
    int64_t analogue_1_mv;
    int64_t analogue_2_mv;
    int64_t forced_supply_mv;
    int64_t logic_mv;
    int64_t gate_mv;
    int64_t ambient_mc;
    int64_t sensor_faults;
    int64_t encoder_loss;
    int64_t mounted_pole_pairs;
    int64_t pins;
    int64_t master;
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
    int64_t square_per_mc;
    int64_t lowest_qc;
    int64_t highest_qc;
    int64_t position_limited;
    int64_t encoder_reversed;
    int64_t encoder_supervised;
    int64_t index_supervised;
    int64_t hall_pole_pairs;
    int64_t hall_angle_supervised;
    int64_t auxiliary_supervised;
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
    int64_t lowest;
    int64_t highest;
    int64_t shape;
    int64_t leg_from;
    int64_t leg_to;
    int64_t leg_ms;
    int64_t leg_at;
    int64_t leg_spare;
    int64_t leg_2_to;
    int64_t leg_2_ms;
    int64_t leg_3_to;
    int64_t leg_3_ms;
    int64_t leg_4_to;
    int64_t leg_4_ms;
    int64_t knot;
    int64_t spline_linear;
    int64_t spline_square;
    int64_t spline_cube;
    int64_t spline_ms;
    int64_t spline_at;
    int64_t next_linear;
    int64_t next_square;
    int64_t next_cube;
    int64_t next_ms;
    int64_t splines_done;
    int64_t gear_counted;
    int64_t gear_numerator;
    int64_t gear_denominator;
    int64_t gear_rest;
    int64_t analogue_input;
    int64_t analogue_numerator;
    int64_t analogue_denominator;
    int64_t analogue_offset;
    int64_t call;
    int64_t pins_watched;
    int64_t index_watched;
    int64_t current_watched_ma;
    int64_t compare_direction;
    int64_t compare_reference;
    int64_t compare_width;
    int64_t compare_first;
    int64_t compare_last;
    int64_t compare_pulse_ms;
    int64_t outputs;
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
    int64_t turning;
    int64_t back_emf;
    int64_t decay_resistance;
    int64_t balance_resistance;
    int64_t learning;
    int64_t raised;
    int64_t braking;
    int64_t left;
    int64_t waits;
    int64_t speed_before;
    int64_t velocity_demand;
    int64_t acceleration_demand;
    int64_t position_demand;
    int64_t velocity_integral;
    int64_t position_integral;
    int64_t derivative;
    int64_t thermal;
    int64_t window_ms;
    int64_t still_ms;
    int64_t event;
    int64_t pins_before;
    int64_t index_position;
    int64_t index_passes;
    int64_t compare_left;
    int64_t compare_hits;
    int64_t turned;
    int64_t slipped;
    int64_t loss_rest;
    int64_t index_count;
    int64_t index_before;
    int64_t index_known;
    int64_t index_judged;
    int64_t switched_on_at;
    int64_t hall_zero;
    int64_t contrary_ms;
    int64_t heat;
    int64_t recording;
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
    void *mirrored_inputs;
    int64_t mirrored_input_count;
    void *mirrored_outputs;
    int64_t mirrored_output_count;
} plant_calls;

typedef struct {
    void *sources;
    void *memory;
    int64_t width;
    int64_t capacity;
    int64_t period;
    int64_t preceding;
    int64_t triggers;
    int64_t left;
    int64_t triggered;
    int64_t remaining;
    int64_t next;
    int64_t filled;
    int64_t moving;
    int64_t pins;
} servo_recorder;

typedef struct {
    int64_t axis;
    int64_t mask;
    int64_t variable;
} servo_line;

typedef struct {
    int64_t count;
    void *axes;
    void *recorders;
    void *counts_per_radian;
    void *dividers;
    int64_t supply;
    int64_t sampled;
    void *input_lines;
    int64_t input_line_count;
    void *output_lines;
    int64_t output_line_count;
    void *plant;
    int64_t tick;
    int64_t fault_axis;
    int64_t fault_status;
    double fault_value;
} servo_bank;

typedef struct {
    int64_t count;
    int64_t seen;
    void *driven;
    void *conducting;
    void *open;
    int64_t period;
    double on_resistance;
    void *torque_constants;
    int64_t supply;
    double constant_supply;
    int64_t sampled;
    double counts_per_radian;
    int64_t most;
    void *places;
    void *turned;
    void *edges;
    void *plant;
    int64_t tick;
    int64_t fault_axis;
    int64_t fault_status;
    double fault_value;
} servo_terminals;

#endif
