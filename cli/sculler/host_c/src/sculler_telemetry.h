/* Navigation states as binary frames with a CRC, for a serial line, a radio or a file.
 *
 * All numbers are little-endian; doubles are IEEE 754.  The payload's fields stand in the order of a
 * ROS 2 message: stamp, orientation (x, y, z, w), velocity, position.
 *
 *     0    2  mark 0x53 0x4E ("SN")
 *     2    1  version, 1
 *     3    1  kind, 1: a navigation state
 *     4    2  length of the payload in bytes, 104
 *     6    2  status bits of the result (SCULLER_FAULT ...)
 *     8    8  number of the frame, from 0
 *     16   8  time, s
 *     24  32  attitude q_nb: x, y, z, w; body to north-east-down
 *     56  24  velocity over the Earth: north, east, down, m/s
 *     80  24  latitude, longitude (rad), height above the ellipsoid (m)
 *     104  8  wander angle, rad
 *     112  4  CRC-32 (IEEE 802.3, as zlib's) of bytes 0 to 111
 */
#ifndef SCULLER_TELEMETRY_H
#define SCULLER_TELEMETRY_H

#include "sculler_nav.h"

#ifdef __cplusplus
extern "C" {
#endif

#define SCULLER_TELEMETRY_BYTES 116

/* CRC-32 of bytes. */
uint32_t sculler_crc32(const uint8_t *bytes, size_t count);

/* Write a state as a frame. */
void sculler_telemetry_write(
    uint8_t frame[SCULLER_TELEMETRY_BYTES],
    const sculler_state *state,
    uint64_t number,
    uint16_t status);

/* Read a frame.  SCULLER_BAD_FRAME: mark, version, kind, length or CRC are not right; nothing is
 * written then. */
sculler_error sculler_telemetry_read(
    const uint8_t frame[SCULLER_TELEMETRY_BYTES],
    sculler_state *state,
    uint64_t *number,
    uint16_t *status);

#ifdef __cplusplus
}
#endif
#endif
