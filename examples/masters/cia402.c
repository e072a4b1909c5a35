/* Enables one drive of CiA 402 on SocketCAN, moves it to a position, and takes its power off again.
 *
 * Usage: cia402 INTERFACE NODE COUNTS        cc -O2 -o cia402 cia402.c
 *
 * Objects by SDO, controlword and statusword by the PDOs that an EPOS2 has from the factory: RPDO1 at 0x200 + node,
 * TPDO1 at 0x180 + node, sent on change. Exit status 0: it is there; 1: the drive has a fault; 2: it does not answer.
 */
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum { NMT = 0x000, EMERGENCY = 0x080, TPDO1 = 0x180, RPDO1 = 0x200, SDO_ANSWER = 0x580, SDO_REQUEST = 0x600 };
enum { FAULT = 1 << 3, TARGET_REACHED = 1 << 10, SET_POINT_TAKEN = 1 << 12 }; /* bits of the statusword */
enum { STATE = 0x6F, READY = 0x21, SWITCHED_ON = 0x23, ENABLED = 0x27 };      /* CiA 402, power states */
enum { ANSWER_MS = 5000, MOVE_MS = 60000 };

static int bus;
static unsigned node, status, emergency;
static struct can_frame answer;

static void end(int code, const char *what)
{
    fprintf(stderr, "node %u: %s, statusword 0x%04X\n", node, what, status);
    exit(code);
}

static long now_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * 1000L + now.tv_nsec / 1000000L;
}

static void send_frame(canid_t id, const uint8_t *data, uint8_t length)
{
    struct can_frame frame = {.can_id = id, .can_dlc = length};
    memcpy(frame.data, data, length);
    if (write(bus, &frame, sizeof frame) != sizeof frame)
        end(2, "the bus takes no frame");
}

/* Take one frame in, and what it says of the drive; return its identifier, 0 where none comes in time. */
static canid_t take(long until)
{
    struct pollfd wait = {.fd = bus, .events = POLLIN};
    struct can_frame frame;
    long left = until - now_ms();
    if (poll(&wait, 1, left > 0 ? (int)left : 0) <= 0 || read(bus, &frame, sizeof frame) != sizeof frame)
        return 0;
    if (frame.can_id == EMERGENCY + node && frame.can_dlc >= 2)
        emergency = frame.data[0] | frame.data[1] << 8;
    if (frame.can_id == TPDO1 + node && frame.can_dlc >= 2)
        status = frame.data[0] | frame.data[1] << 8;
    if (frame.can_id == SDO_ANSWER + node)
        answer = frame;
    return frame.can_id;
}

/* One expedited transfer (CiA 301); `size` 0 reads. */
static uint32_t sdo(unsigned index, unsigned subindex, unsigned size, uint32_t value)
{
    uint8_t data[8] = {size ? 0x23 | (4 - size) << 2 : 0x40, index, index >> 8, subindex,
                       value, value >> 8, value >> 16, value >> 24};
    long until = now_ms() + ANSWER_MS;
    send_frame(SDO_REQUEST + node, data, 8);
    while (now_ms() < until) {
        if (take(until) != SDO_ANSWER + node || memcmp(answer.data + 1, data + 1, 3) != 0)
            continue;
        if (answer.data[0] == 0x80)
            end(2, "an object is refused");
        memcpy(&value, answer.data + 4, 4); /* both are little-endian */
        return answer.data[0] == 0x4B ? value & 0xFFFF : value;
    }
    end(2, "no answer by SDO");
    return 0;
}

/* Send a controlword by RPDO1, and wait until the statusword is as it should be then. */
static void command(unsigned word, unsigned mask, unsigned wanted, long within, const char *what)
{
    uint8_t data[2] = {word, word >> 8};
    long until = now_ms() + within;
    char said[80];
    send_frame(RPDO1 + node, data, 2);
    while ((status & mask) != wanted && now_ms() < until) {
        take(until);
        if (status & FAULT) {
            take(now_ms() + 100); /* its cause may be right behind */
            snprintf(said, sizeof said, "fault, emergency 0x%04X, not %s", emergency, what);
            end(1, said);
        }
    }
    if ((status & mask) != wanted) {
        snprintf(said, sizeof said, "not %s in time", what);
        end(2, said);
    }
}

int main(int count, char **words)
{
    struct sockaddr_can place = {.can_family = AF_CAN};
    uint8_t start[2] = {1, 0};
    if (count != 4) {
        fprintf(stderr, "usage: %s INTERFACE NODE COUNTS\n", words[0]);
        return 2;
    }
    node = strtoul(words[2], NULL, 0);
    place.can_ifindex = if_nametoindex(words[1]);
    bus = socket(PF_CAN, SOCK_RAW, CAN_RAW);
    if (bus < 0 || !place.can_ifindex || bind(bus, (struct sockaddr *)&place, sizeof place) < 0) {
        perror(words[1]);
        return 2;
    }
    sdo(0x6060, 0, 1, 1); /* profile position */
    sdo(0x6067, 0, 4, 20); /* counts: without this window the end of the profile counts, not where the shaft is */
    sdo(0x6068, 0, 2, 200); /* ms: without this time a shaft that runs through the window is there, too */
    sdo(0x607A, 0, 4, strtol(words[3], NULL, 0));
    status = sdo(0x6041, 0, 0, 0);
    start[1] = node;
    send_frame(NMT, start, 2); /* PDOs are taken and sent from here on */
    command(0x06, STATE, READY, ANSWER_MS, "ready");
    command(0x07, STATE, SWITCHED_ON, ANSWER_MS, "switched on");
    command(0x0F, STATE, ENABLED, ANSWER_MS, "enabled");
    printf("node %u: enabled\n", node);
    fflush(stdout);
    command(0x1F, SET_POINT_TAKEN, SET_POINT_TAKEN, ANSWER_MS, "on its way");
    command(0x0F, SET_POINT_TAKEN | TARGET_REACHED, TARGET_REACHED, MOVE_MS, "there");
    printf("node %u: at %d\n", node, (int32_t)sdo(0x6064, 0, 0, 0));
    command(0x06, STATE, READY, ANSWER_MS, "without power");
    return 0;
}
