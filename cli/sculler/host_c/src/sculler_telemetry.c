/* Navigation states as binary frames. */
#include "sculler_telemetry.h"

#define CRC_AT 112u
#define KIND_BYTES 6u

static const uint8_t kind[KIND_BYTES] = {0x53, 0x4E, 1, 1, 104, 0};

/* The bits of a double; C99 lets a union tell them. */
typedef union {
    double number;
    uint64_t bits;
} double_bits;

static uint8_t *put(uint8_t *to, uint64_t value, unsigned bytes)
{
    uint64_t rest = value;
    for (unsigned i = 0; i < bytes; i++) {
        to[i] = (uint8_t)(rest & 0xFFu);
        rest >>= 8;
    }
    return to + bytes;
}

static uint8_t *put_double(uint8_t *to, double number)
{
    double_bits of;
    of.number = number;
    return put(to, of.bits, 8u);
}

static uint64_t got(const uint8_t *from, unsigned bytes)
{
    uint64_t value = 0;
    for (unsigned i = bytes; i > 0u; i--) {
        value = value << 8 | from[i - 1u];
    }
    return value;
}

static double got_double(const uint8_t *from)
{
    double_bits of;
    of.bits = got(from, 8u);
    return of.number;
}

uint32_t sculler_crc32(const uint8_t *bytes, size_t count)
{
    /* four bits at a time, the polynomial 0x04C11DB7 with its bits reversed */
    static const uint32_t table[16] = {
        0x00000000u, 0x1DB71064u, 0x3B6E20C8u, 0x26D930ACu, 0x76DC4190u, 0x6B6B51F4u, 0x4DB26158u,
        0x5005713Cu, 0xEDB88320u, 0xF00F9344u, 0xD6D6A3E8u, 0xCB61B38Cu, 0x9B64C2B0u, 0x86D3D2D4u,
        0xA00AE278u, 0xBDBDF21Cu};
    uint32_t crc = 0xFFFFFFFFu;
    for (size_t i = 0; i < count; i++) {
        crc ^= bytes[i];
        crc = crc >> 4 ^ table[crc & 15u];
        crc = crc >> 4 ^ table[crc & 15u];
    }
    return ~crc;
}

void sculler_telemetry_write(
    uint8_t frame[SCULLER_TELEMETRY_BYTES],
    const sculler_state *state,
    uint64_t number,
    uint16_t status)
{
    uint8_t *to = frame;
    for (unsigned i = 0; i < KIND_BYTES; i++) {
        to = put(to, kind[i], 1u);
    }
    to = put(to, status, 2u);
    to = put(to, number, 8u);
    to = put_double(to, sculler_double_of(state->time));
    to = put_double(to, sculler_double_of(state->q.x));
    to = put_double(to, sculler_double_of(state->q.y));
    to = put_double(to, sculler_double_of(state->q.z));
    to = put_double(to, sculler_double_of(state->q.w));
    to = put_double(to, sculler_double_of(state->v.x));
    to = put_double(to, sculler_double_of(state->v.y));
    to = put_double(to, sculler_double_of(state->v.z));
    to = put_double(to, sculler_double_of(state->lat));
    to = put_double(to, sculler_double_of(state->lon));
    to = put_double(to, sculler_double_of(state->h));
    to = put_double(to, sculler_double_of(state->wander));
    (void)put(to, sculler_crc32(frame, CRC_AT), 4u);
}

sculler_error sculler_telemetry_read(
    const uint8_t frame[SCULLER_TELEMETRY_BYTES],
    sculler_state *state,
    uint64_t *number,
    uint16_t *status)
{
    for (unsigned i = 0; i < KIND_BYTES; i++) {
        if (frame[i] != kind[i]) {
            return SCULLER_BAD_FRAME;
        }
    }
    if (got(frame + CRC_AT, 4u) != sculler_crc32(frame, CRC_AT)) {
        return SCULLER_BAD_FRAME;
    }
    *status = (uint16_t)got(frame + 6, 2u);
    *number = got(frame + 8, 8u);
    state->time = sculler_real_of(got_double(frame + 16));
    state->q.x = sculler_real_of(got_double(frame + 24));
    state->q.y = sculler_real_of(got_double(frame + 32));
    state->q.z = sculler_real_of(got_double(frame + 40));
    state->q.w = sculler_real_of(got_double(frame + 48));
    state->v.x = sculler_real_of(got_double(frame + 56));
    state->v.y = sculler_real_of(got_double(frame + 64));
    state->v.z = sculler_real_of(got_double(frame + 72));
    state->lat = sculler_real_of(got_double(frame + 80));
    state->lon = sculler_real_of(got_double(frame + 88));
    state->h = sculler_real_of(got_double(frame + 96));
    state->wander = sculler_real_of(got_double(frame + 104));
    return SCULLER_OK;
}
