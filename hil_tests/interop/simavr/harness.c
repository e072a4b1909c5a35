/* The sketch's own binary in simavr, in lock-step: who drives it says when time passes and what happens.
 *
 * usage: harness SKETCH.elf. On stdin a line for each thing that happens; when the sketch is at rest again, a
 * line on stdout: what it has said on serial, in hex, a blank, and its transfers on the I2C bus. A transfer is
 * ADDRESSwBYTES or ADDRESSrBYTES, `+` a repeated START, `,` follows each STOP.
 *
 *   b HEX        bytes on serial, one after the other
 *   t MS         millis() is that from now on
 *   e WHEEL N    an encoder turns by N edges, one after the other, backwards where N is negative
 *   p PIN LEVEL  someone drives a pin, by its number on the board
 *   a PIN MV     a voltage at an analog input
 *
 * simavr's clock is not the chip's to the cycle, so millis() stands from when the sketch's loop begins: its timer
 * runs on, and what its interrupt counts is put back.
 * On the bus sits a chip with 256 registers that counts them up where bit 5 of the first says so: what a sketch
 * can see of a PCA9685.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <simavr/avr_adc.h>
#include <simavr/avr_ioport.h>
#include <simavr/avr_twi.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>

enum {
  CHIP = 0x60,
  AUTO_INCREMENT = 0x20,
  RESTART = 0x80,
  CHARACTER = 3100,      /* cycles of ten bits at 57600 baud, with those that simavr adds */
  REST = 3 * CHARACTER,  /* without a byte on serial or I2C, and in the loop */
  EDGE = 300,            /* cycles until an edge has been counted */
  STUCK = 160000000,
  PINS = 70,
  FIRST_ANALOG = 54,
  WHEELS = 3,
};

static const char WHERE[PINS][3] = {
    "E0", "E1", "E4", "E5", "G5", "E3", "H3", "H4", "H5", "H6", "B4", "B5", "B6", "B7", "J1", "J0", "H1", "H0",
    "D3", "D2", "D1", "D0", "A0", "A1", "A2", "A3", "A4", "A5", "A6", "A7", "C7", "C6", "C5", "C4", "C3", "C2",
    "C1", "C0", "D7", "G2", "G1", "G0", "L7", "L6", "L5", "L4", "L3", "L2", "L1", "L0", "B3", "B2", "B1", "B0",
    "F0", "F1", "F2", "F3", "F4", "F5", "F6", "F7", "K0", "K1", "K2", "K3", "K4", "K5", "K6", "K7",
};
static const int ENCODERS[WHEELS][2] = {{2, 3}, {18, 19}, {10, 11}};
static const int IDLE_HIGH[] = {0, 1, 20, 21};

static FILE *out; /* simavr has words of its own for stdout: they go where errors go */
static avr_t *avr;
static avr_cycle_count_t last_event;
static uint32_t loop_at, millis_at, millis;
static int given; /* whether millis() is */
static int full;
static uint8_t driven[128], level[128]; /* of a port, by its letter */
static int places[WHEELS];

static uint8_t said[1 << 16];
static size_t said_count;
static char carried[1 << 20];
static size_t carried_count;

static uint8_t registers[256], pointer;
static int selected, choosing, idle = 1;
static avr_irq_t *twi_in;

static void fail(const char *what) {
  fprintf(stderr, "harness: %s\n", what);
  exit(1);
}

/* Serial */

static void on_byte(avr_irq_t *irq, uint32_t value, void *param) {
  (void)irq, (void)param;
  last_event = avr->cycle;
  if (said_count == sizeof said)
    fail("the sketch says more than there is room for");
  said[said_count++] = value;
}

static void on_room(avr_irq_t *irq, uint32_t value, void *param) {
  (void)irq, (void)value;
  full = param != NULL;
}

/* I2C */

static void note(const char *format, int value) {
  if (carried_count + 8 > sizeof carried)
    fail("more on the I2C bus than there is room for");
  carried_count += sprintf(carried + carried_count, format, value);
}

static void next_register(void) {
  if (registers[0] & AUTO_INCREMENT)
    pointer++;
}

static void on_bus(avr_irq_t *irq, uint32_t value, void *param) {
  (void)irq, (void)param;
  avr_twi_msg_irq_t it = {.u.v = value};
  uint8_t msg = it.u.twi.msg;
  last_event = avr->cycle;
  if (msg & TWI_COND_STOP) {
    note(",", 0);
    selected = 0;
    idle = 1;
  }
  if (msg & TWI_COND_START) {
    note(idle ? "%02X" : "+%02X", it.u.twi.addr >> 1);
    note(it.u.twi.addr & 1 ? "r" : "w", 0);
    idle = 0;
    selected = it.u.twi.addr >> 1 == CHIP;
    choosing = !(it.u.twi.addr & 1);
    if (selected)
      avr_raise_irq(twi_in, avr_twi_irq_msg(TWI_COND_ACK, it.u.twi.addr, 1));
  }
  if (!selected)
    return;
  if (msg & TWI_COND_WRITE) {
    note("%02X", it.u.twi.data);
    avr_raise_irq(twi_in, avr_twi_irq_msg(TWI_COND_ACK, it.u.twi.addr, 1));
    if (choosing) {
      pointer = it.u.twi.data;
    } else {
      registers[pointer] = it.u.twi.data & (pointer ? 0xff : 0xff & ~RESTART);
      next_register();
    }
    choosing = 0;
  }
  if (msg & TWI_COND_READ) {
    note("%02X", registers[pointer]);
    avr_raise_irq(twi_in, avr_twi_irq_msg(TWI_COND_READ, it.u.twi.addr, registers[pointer]));
    next_register();
  }
}

/* Pins */

static void put(int pin, int high) {
  char port = WHERE[pin][0];
  int bit = WHERE[pin][1] - '0';
  driven[(int)port] |= 1 << bit;
  level[(int)port] = (level[(int)port] & ~(1 << bit)) | (high != 0) << bit;
  avr_ioport_external_t held = {.name = port, .mask = driven[(int)port], .value = level[(int)port]};
  avr_ioctl(avr, AVR_IOCTL_IOPORT_SET_EXTERNAL(port), &held);
  avr_raise_irq(avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ(port), bit), high != 0);
}

/* What no one drives reads low: simavr would leave it as it was. */
static void floats(char port, uint8_t ddr, uint8_t latch) {
  for (int bit = 0; bit < 8; bit++)
    if (!((ddr | latch | driven[(int)port]) >> bit & 1))
      avr_raise_irq(avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ(port), bit), 0);
}

static void on_direction(avr_irq_t *irq, uint32_t value, void *param) {
  (void)irq;
  avr_ioport_state_t now;
  char port = *(const char *)param;
  avr_ioctl(avr, AVR_IOCTL_IOPORT_GETSTATE(port), &now);
  /* What drove a pin that was an output simavr forgets as soon as the sketch reads it, and does not say again. */
  for (int bit = 0; bit < 8; bit++)
    if (now.ddr & ~value & driven[(int)port] & 1 << bit) {
      avr_irq_t *pin = avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ(port), bit);
      avr_raise_irq(pin, !(level[(int)port] >> bit & 1));
      avr_raise_irq(pin, level[(int)port] >> bit & 1);
    }
  floats(port, value, now.port);
}

static void on_latch(avr_irq_t *irq, uint32_t value, void *param) {
  (void)irq;
  avr_ioport_state_t now;
  avr_ioctl(avr, AVR_IOCTL_IOPORT_GETSTATE(*(const char *)param), &now);
  floats(*(const char *)param, now.ddr, value);
}

static void put_encoder(int wheel) {
  int place = places[wheel] & 3;
  put(ENCODERS[wheel][0], place == 1 || place == 2);
  put(ENCODERS[wheel][1], place == 2 || place == 3);
}

/* Time */

static void step(void) {
  int state = avr_run(avr);
  if (state == cpu_Crashed || state == cpu_Done)
    fail("the sketch has crashed");
  if (given)
    for (int n = 0; n < 4; n++)
      avr->data[millis_at + n] = millis >> 8 * n;
}

static void run(avr_cycle_count_t cycles) {
  avr_cycle_count_t until = avr->cycle + cycles;
  while (avr->cycle < until)
    step();
}

static void run_into_loop(avr_cycle_count_t rest) {
  avr_cycle_count_t begun = avr->cycle;
  while (avr->cycle - last_event < rest || avr->pc != loop_at) {
    step();
    if (avr->cycle - begun > STUCK)
      fail("the sketch does not come to rest");
  }
}

static void send(const char *hex) {
  unsigned byte;
  avr_irq_t *in = avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT);
  for (; sscanf(hex, "%2x", &byte) == 1; hex += 2) {
    while (full)
      step();
    avr_raise_irq(in, byte);
    last_event = avr->cycle;
    run(CHARACTER);
  }
}

static void load(const char *path) {
  static elf_firmware_t firmware;
  if (elf_read_firmware(path, &firmware))
    fail("this is no sketch");
  for (uint32_t n = 0; n < firmware.symbolcount; n++) {
    if (!strcmp(firmware.symbol[n]->symbol, "loop"))
      loop_at = firmware.symbol[n]->addr;
    if (!strcmp(firmware.symbol[n]->symbol, "timer0_millis"))
      millis_at = firmware.symbol[n]->addr & 0xffff;
  }
  if (!loop_at || !millis_at)
    fail("the sketch lacks the symbol loop or timer0_millis");
  avr = avr_make_mcu_by_name("atmega2560");
  if (!avr)
    fail("simavr has no atmega2560");
  avr_init(avr);
  avr->log = LOG_ERROR;
  avr->frequency = 16000000;
  avr->vcc = avr->avcc = avr->aref = 5000;
  avr_load_firmware(avr, &firmware);
}

static void connect(void) {
  static const char PORTS[] = "ABCDEFGHJKL";
  uint32_t flags = 0;
  avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
  uint32_t uart = AVR_IOCTL_UART_GETIRQ('0'), twi = AVR_IOCTL_TWI_GETIRQ(0);
  avr_irq_register_notify(avr_io_getirq(avr, uart, UART_IRQ_OUTPUT), on_byte, NULL);
  avr_irq_register_notify(avr_io_getirq(avr, uart, UART_IRQ_OUT_XON), on_room, NULL);
  avr_irq_register_notify(avr_io_getirq(avr, uart, UART_IRQ_OUT_XOFF), on_room, &full);
  twi_in = avr_io_getirq(avr, twi, TWI_IRQ_INPUT);
  avr_irq_register_notify(avr_io_getirq(avr, twi, TWI_IRQ_OUTPUT), on_bus, NULL);
  for (const char *port = PORTS; *port; port++) {
    uint32_t pins = AVR_IOCTL_IOPORT_GETIRQ(*port);
    avr_irq_register_notify(avr_io_getirq(avr, pins, IOPORT_IRQ_DIRECTION_ALL), on_direction, (void *)port);
    avr_irq_register_notify(avr_io_getirq(avr, pins, IOPORT_IRQ_REG_PORT), on_latch, (void *)port);
  }
  for (size_t n = 0; n < sizeof IDLE_HIGH / sizeof *IDLE_HIGH; n++)
    put(IDLE_HIGH[n], 1);
  for (int wheel = 0; wheel < WHEELS; wheel++)
    put_encoder(wheel);
}

static void tell(void) {
  for (size_t n = 0; n < said_count; n++)
    fprintf(out, "%02X", said[n]);
  fprintf(out, " %.*s\n", (int)carried_count, carried);
  fflush(out);
  said_count = carried_count = 0;
}

static void happen(const char *line) {
  int first = 0, second = 0;
  sscanf(line + 1, "%d %d", &first, &second);
  switch (line[0]) {
  case 'b':
    send(line + 2);
    break;
  case 't':
    millis = strtoul(line + 1, NULL, 10);
    break;
  case 'e':
    for (; second; second -= second > 0 ? 1 : -1) {
      places[first] += second > 0 ? 1 : -1;
      put_encoder(first);
      run(EDGE);
    }
    break;
  case 'p':
    put(first, second);
    break;
  case 'a':
    avr_raise_irq(avr_io_getirq(avr, AVR_IOCTL_ADC_GETIRQ, first - FIRST_ANALOG), second);
    break;
  default:
    fail("no such thing happens");
  }
  last_event = line[0] == 'b' || line[0] == 't' ? avr->cycle : last_event;
}

int main(int count, char **words) {
  static char line[1 << 16];
  if (count != 2)
    fail("usage: harness SKETCH.elf");
  out = fdopen(dup(STDOUT_FILENO), "w");
  dup2(STDERR_FILENO, STDOUT_FILENO);
  load(words[1]);
  connect();
  run_into_loop(0);
  given = 1;
  run_into_loop(REST);
  tell();
  while (fgets(line, sizeof line, stdin)) {
    happen(line);
    run_into_loop(REST);
    tell();
  }
  return 0;
}
