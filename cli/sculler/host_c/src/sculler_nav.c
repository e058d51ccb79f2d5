/* The wander azimuth: the arithmetic of one major interval (Savage-98 Table 1). */
#include "sculler_nav.h"

#include "sculler_math.h"

#define MIN_HEIGHT (-10e3)  /* m, to navigate in */
#define MAX_HEIGHT (1000e3)
#define HOLD 10.0 /* s, the age to which a measured height serves */
#define AT_POLE 1e-12 /* cosine of latitude: 6 um from a pole */
#define DEGREES (180.0 / SCULLER_PI)

/* ---- the Earth ------------------------------------------------------------------------------ */

void sculler_radii(sculler_real sin_lat, sculler_real *meridian, sculler_real *prime_vertical)
{
    sculler_real squash = 1.0 - SCULLER_ECCENTRICITY_SQUARED * sin_lat * sin_lat;
    *prime_vertical = SCULLER_SEMI_MAJOR_AXIS / sqrt(squash);
    *meridian = *prime_vertical * ((1.0 - SCULLER_ECCENTRICITY_SQUARED) / squash);
}

/* Normal gravity of WGS-84 at any height, by its closed form: the gradient of the potential of the
 * level ellipsoid that turns (Heiskanen and Moritz, Physical Geodesy, Eq. 2-126 to 2-130), with
 * their q' and q less the leading power of E/u as series in x = E^2/u^2. */
static sculler_real normal_gravity(sculler_real sin_lat, sculler_real height, sculler_real *lean)
{
    const sculler_real focus_squared =
        SCULLER_ECCENTRICITY_SQUARED * (SCULLER_SEMI_MAJOR_AXIS * SCULLER_SEMI_MAJOR_AXIS);
    const sculler_real rotation_k = 4.191445418836073e+26; /* w^2 a^2 E^3 / q_0, m^5/s^2 */
    const sculler_real rate_squared = SCULLER_EARTH_RATE * SCULLER_EARTH_RATE;

    sculler_real squash = 1.0 - SCULLER_ECCENTRICITY_SQUARED * sin_lat * sin_lat;
    sculler_real prime_vertical = SCULLER_SEMI_MAJOR_AXIS / sqrt(squash);
    sculler_real bulge = SCULLER_ECCENTRICITY_SQUARED * prime_vertical * sin_lat;
    sculler_real out = prime_vertical + height; /* X = out n - bulge k, n the ellipsoid's normal */
    sculler_real z = out * sin_lat - bulge;
    sculler_real z_squared = z * z;
    sculler_real inner = out * (out - 2.0 * bulge * sin_lat) + bulge * bulge - focus_squared;
    sculler_real L = sqrt(inner * inner + 4.0 * focus_squared * z_squared);
    sculler_real per_u2 = 2.0 / (inner + L);
    sculler_real x = focus_squared * per_u2;
    sculler_real sin2_beta = z_squared * per_u2;
    sculler_real s_p =
        2.0 / 5.0
        - x * (6.0 / 35.0
               - x * (2.0 / 21.0 - x * (2.0 / 33.0 - x * (6.0 / 143.0 - x * (2.0 / 65.0)))));
    sculler_real s_q =
        2.0 / 15.0
        - x * (4.0 / 35.0
               - x * (2.0 / 21.0 - x * (8.0 / 99.0 - x * (10.0 / 143.0 - x * (4.0 / 65.0)))));
    sculler_real B = SCULLER_GM + rotation_k * per_u2 * s_p * (0.5 * sin2_beta - 1.0 / 6.0);
    sculler_real C = rotation_k * per_u2 * s_q * (1.0 + x);
    sculler_real scale = sqrt(per_u2) / (L * (1.0 + x));
    sculler_real P = rate_squared - (B + C * sin2_beta) * scale; /* with the centrifugal force */
    sculler_real along_axis = -rate_squared * z - (B * x - C) * scale * z;
    *lean = along_axis - P * bulge;
    return -(P * out + *lean * sin_lat);
}

/* The points of an axis on either side of a value; returns the part of the step to it. */
static sculler_real between_points(
    const double *axis, size_t count, sculler_real value, size_t *low, size_t *high)
{
    *low = 0;
    *high = 0;
    if (count < 2u) {
        return 0.0;
    }
    *high = count - 1u;
    while (*high - *low > 1u) {
        size_t middle = (*low + *high) / 2u;
        if ((sculler_real)axis[middle] <= value) {
            *low = middle;
        } else {
            *high = middle;
        }
    }
    sculler_real start = (sculler_real)axis[*low];
    return (value - start) / ((sculler_real)axis[*high] - start);
}

/* What a table has more than normal gravity at a latitude (degrees) and height (m). */
static sculler_real excess(const sculler_gravity_table *table, sculler_real lat, sculler_real height)
{
    size_t i, k, j, m, columns = table->height_count;
    sculler_real right = between_points(table->lats, table->lat_count, lat, &i, &k);
    sculler_real above = between_points(table->heights, columns, height, &j, &m);
    const double *left_row = table->excess + i * columns;
    const double *right_row = table->excess + k * columns;
    sculler_real left_low = (sculler_real)left_row[j], left_high = (sculler_real)left_row[m];
    sculler_real low = left_low + right * ((sculler_real)right_row[j] - left_low);
    sculler_real high = left_high + right * ((sculler_real)right_row[m] - left_high);
    return low + above * (high - low);
}

sculler_real sculler_gravity_at(const sculler_gravity *model, sculler_real sin_lat, sculler_real height, sculler_real *lean)
{
    if (model->is_constant) {
        *lean = 0.0;
        return model->value;
    }
    sculler_real down = normal_gravity(sin_lat, height, lean);
    if (model->table != NULL) {
        sculler_real sine = sin_lat < -1.0 ? -1.0 : sin_lat > 1.0 ? 1.0 : sin_lat;
        down += excess(model->table, asin(sine) * DEGREES, height);
    }
    return down;
}

static bool axis_holds(const double *axis, size_t count, sculler_real value)
{
    /* a start on the very edge is not refused for rounding */
    sculler_real size = fabs(value);
    sculler_real slack = 1e-9 * (size > 1.0 ? size : 1.0);
    return count < 2u
           || ((sculler_real)axis[0] - slack <= value
               && value <= (sculler_real)axis[count - 1u] + slack);
}

/* Whether a model of gravity holds at a latitude (rad) and height (m). */
static bool covers(const sculler_gravity *model, sculler_real lat, sculler_real height)
{
    const sculler_gravity_table *table = model->table;
    if (!(MIN_HEIGHT <= height && height <= MAX_HEIGHT)) {
        return false;
    }
    return table == NULL
           || (axis_holds(table->lats, table->lat_count, lat * DEGREES)
               && axis_holds(table->heights, table->height_count, height));
}

/* The Earth at q_ew and height h (m), in w.
 *
 * The polar axis P in w is the third row of C_ew.  The principal curvatures differ by
 * kappa cos^2 lat, so turned into w they are 1/(R_N + h) + kappa P P^T: regular at the poles, and
 * so is gravity's horizontal part, which goes with cos lat as well. */
static sculler_earth earth_at(sculler_quaternion place, sculler_real h, const sculler_gravity *model)
{
    sculler_vector polar = sculler_third_row(place);
    sculler_real meridian, prime_vertical, leaning;
    sculler_radii(polar.z, &meridian, &prime_vertical);
    sculler_real across = 1.0 / (prime_vertical + h);
    sculler_real kappa = SCULLER_ECCENTRICITY_SQUARED / (1.0 - SCULLER_ECCENTRICITY_SQUARED) * across
                   * meridian / (meridian + h);
    sculler_real down = sculler_gravity_at(model, -polar.z, h, &leaning);
    sculler_earth earth;
    earth.rate = sculler_times(SCULLER_EARTH_RATE, polar);
    earth.curvature.x = across + kappa * polar.x * polar.x;
    earth.curvature.y = kappa * polar.x * polar.y;
    earth.curvature.z = across + kappa * polar.y * polar.y;
    earth.gravity.x = leaning * polar.x;
    earth.gravity.y = leaning * polar.y;
    earth.gravity.z = down;
    return earth;
}

/* A part of the way (1: all of it) from a to b, on the straight line. */
static sculler_earth between(const sculler_earth *a, const sculler_earth *b, sculler_real part)
{
    sculler_earth found;
    found.rate = sculler_plus(a->rate, sculler_plus(b->rate, a->rate, -1.0), part);
    found.curvature =
        sculler_plus(a->curvature, sculler_plus(b->curvature, a->curvature, -1.0), part);
    found.gravity = sculler_plus(a->gravity, sculler_plus(b->gravity, a->gravity, -1.0), part);
    return found;
}

/* F_C (u x moved): rotation (rad) over the Earth of a displacement (m), both in w; of a velocity
 * (m/s) the rate of that rotation, rad/s (Savage-98 Eq. 3, with no rate about the vertical). */
static sculler_vector travelled(sculler_vector curvature, sculler_vector moved)
{
    sculler_vector turn;
    turn.x = curvature.y * moved.x + curvature.z * moved.y;
    turn.y = -curvature.x * moved.x - curvature.y * moved.y;
    turn.z = 0.0;
    return turn;
}

/* ---- geographic terms ----------------------------------------------------------------------- */

/* q_ew of latitude, longitude and wander angle (rad): C_en = R_z(lon) R_y(-90 deg - lat). */
static sculler_quaternion place_at(sculler_real lat, sculler_real lon, sculler_real wander)
{
    sculler_real theta = -0.5 * SCULLER_PI - lat;
    sculler_quaternion to_earth = {cos(0.5 * theta), 0.0, sin(0.5 * theta), 0.0};
    sculler_quaternion turned = sculler_product(to_earth, sculler_about_z(wander));
    return sculler_normalised(sculler_product(sculler_about_z(lon), turned));
}

/* atan2(sine, cosine) of a cosine and a sine of one angle (rad). */
static sculler_real angle_of(sculler_real cosine, sculler_real sine)
{
    if (fabs(sine) >= fabs(cosine)) {
        return copysign(0.5 * SCULLER_PI - asin(cosine), sine);
    }
    sculler_real small = asin(sine);
    return cosine > 0.0 ? small : copysign(SCULLER_PI, sine) - small;
}

/* q_ew and height (m) at the end of the last interval (Savage-98 Eq. 64, 68, 70). */
static sculler_quaternion position(const sculler_nav *nav, sculler_real *h)
{
    if (nav->since == 0u) {
        *h = nav->h;
        return nav->place;
    }
    *h = nav->h + nav->climb;
    return sculler_normalised(
        sculler_product(nav->place, sculler_from_rotation_vector(nav->travel)));
}

/* All of a state but its time, of q_wb, the velocity in w, and q_ew. */
static void geographic(
    sculler_quaternion q, sculler_vector v, sculler_quaternion place, sculler_state *state)
{
    sculler_real w = place.w, x = place.x, y = place.y, z = place.z;
    sculler_real xz = 2.0 * (x * z + w * y), yz = 2.0 * (y * z - w * x);
    sculler_vector polar = sculler_third_row(place);
    sculler_real cos_lat = sqrt(xz * xz + yz * yz); /* the third column of C_ew is down */
    state->lat = angle_of(cos_lat, -polar.z);
    if (cos_lat <= AT_POLE) { /* north is the frame's x axis */
        sculler_real xx = 1.0 - 2.0 * (y * y + z * z), yx = 2.0 * (x * y + w * z);
        state->lon = state->lat > 0.0 ? atan2(-yx, -xx) : atan2(yx, xx);
        state->q = q;
        state->v = v;
        state->wander = 0.0;
        return;
    }
    sculler_real per = 1.0 / cos_lat;
    state->lon = angle_of(-per * xz, -per * yz);
    /* the polar axis in w is (cos lat cos a, -cos lat sin a, -sin lat) */
    sculler_real c = per * polar.x, s = -per * polar.y;
    sculler_real half_c, half_s;
    state->wander = angle_of(c, s);
    if (c > 0.0) { /* of a/2 the larger one of cosine and sine by the square root */
        half_c = sqrt(0.5 + 0.5 * c);
        half_s = 0.5 * s / half_c;
    } else {
        half_s = copysign(sqrt(0.5 - 0.5 * c), s);
        half_c = 0.5 * s / half_s;
    }
    state->q.w = half_c * q.w - half_s * q.z;
    state->q.x = half_c * q.x - half_s * q.y;
    state->q.y = half_c * q.y + half_s * q.x;
    state->q.z = half_c * q.z + half_s * q.w;
    state->v.x = c * v.x - s * v.y;
    state->v.y = s * v.x + c * v.y;
    state->v.z = v.z;
}

void sculler_nav_state(const sculler_nav *nav, sculler_state *state)
{
    sculler_quaternion place = position(nav, &state->h);
    geographic(nav->q, nav->v, place, state);
    state->time = nav->start + (sculler_real)nav->updates * nav->settings.interval;
}

void sculler_nav_set_time(sculler_nav *nav, sculler_real time)
{
    nav->start = time;
    nav->updates = 0;
}

sculler_vector sculler_euler(sculler_quaternion q)
{
    sculler_real w = q.w, x = q.x, y = q.y, z = q.z;
    sculler_real sin_pitch = 2.0 * (w * y - x * z);
    sculler_real forward_n = 1.0 - 2.0 * (y * y + z * z), forward_e = 2.0 * (x * y + w * z);
    sculler_real cos_pitch = sqrt(forward_n * forward_n + forward_e * forward_e);
    sculler_vector angles;
    if (cos_pitch < 1e-9) {
        angles.x = 0.0;
        angles.y = copysign(0.5 * SCULLER_PI, sin_pitch);
        angles.z = atan2(2.0 * (w * z - x * y), 1.0 - 2.0 * (x * x + z * z));
    } else {
        angles.x = atan2(2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y));
        angles.y = atan2(sin_pitch, cos_pitch);
        angles.z = atan2(forward_e, forward_n);
    }
    return angles;
}

void sculler_coast(sculler_state *state, sculler_real seconds)
{
    sculler_quaternion to_level = sculler_about_z(-state->wander);
    sculler_quaternion place = place_at(state->lat, state->lon, state->wander);
    sculler_real meridian, prime_vertical;
    sculler_radii(sin(state->lat), &meridian, &prime_vertical);
    sculler_vector turn;
    turn.x = seconds * state->v.y / (prime_vertical + state->h);
    turn.y = -seconds * state->v.x / (meridian + state->h);
    turn.z = 0.0;
    sculler_quaternion turned = sculler_from_rotation_vector(sculler_rotate(to_level, turn));
    place = sculler_normalised(sculler_product(place, turned));
    sculler_quaternion q = sculler_product(to_level, state->q);
    sculler_vector v = sculler_rotate(to_level, state->v);
    state->h = state->h - seconds * state->v.z;
    state->time = state->time + seconds;
    geographic(q, v, place, state);
}

/* ---- one major interval --------------------------------------------------------------------- */

/* zeta (rad) over an interval at velocity v; gets gravity with Coriolis (m/s) (Eq. 7, 17). */
static sculler_vector turned_and_pulled(
    const sculler_earth *there, sculler_vector v, sculler_real T, sculler_vector *dv_g_cor)
{
    sculler_vector w_en = travelled(there->curvature, v);
    sculler_vector coriolis = sculler_cross(sculler_plus(w_en, there->rate, 2.0), v);
    *dv_g_cor = sculler_times(T, sculler_plus(there->gravity, coriolis, -1.0));
    return sculler_times(T, sculler_plus(there->rate, w_en, 1.0));
}

/* Velocity (m/s) at the end of the interval; gets the displacement over it (m), both in w.
 *
 * The frame w turns by zeta while the specific force acts.  A force constant in w then gives
 * (I - 1/2 zeta x + (zeta x)^2/12) C_wb dV_SF, exact to zeta^4/720, and its double integral
 * -(zeta x/6 - (zeta x)^2/24) C_wb dV_SF T.  With dR_SF Coriolis and transport rate are those of
 * the mean velocity, and -1/2 zeta x dV_SF becomes -zeta x (dV_SF - dR_SF/T), which holds for any
 * course of the force (Savage-98 Eq. 4-7, 11, 13, 75, 83). */
static sculler_vector carried(
    const sculler_nav *nav,
    const sculler_earth *mid,
    sculler_real damped_down,
    const sculler_increments *increments,
    sculler_vector *moved)
{
    sculler_real T = nav->settings.interval;
    sculler_vector damped = {0.0, 0.0, damped_down};
    sculler_vector v_mid =
        sculler_plus(nav->v, sculler_plus(nav->v, nav->v_past, -1.0), 0.5);
    sculler_vector dv_g_cor, dv_sf_w;
    sculler_vector zeta = turned_and_pulled(mid, v_mid, T, &dv_g_cor);
    sculler_vector dv = sculler_rotate(nav->q, increments->dv_sf);
    sculler_vector once = sculler_cross(zeta, dv);
    sculler_vector twice = sculler_cross(zeta, once);

    if (increments->displaced) {
        sculler_vector dr = sculler_rotate(nav->q, increments->dr_sf);
        sculler_vector half =
            sculler_plus(sculler_plus(nav->v, dv_g_cor, 0.5), damped, 0.5);
        half = sculler_plus(sculler_plus(half, once, -1.0 / 6.0), twice, 1.0 / 24.0);
        *moved = sculler_plus(dr, half, T);
        zeta = turned_and_pulled(mid, sculler_per(*moved, T), T, &dv_g_cor);
        sculler_vector lag = sculler_cross(zeta, sculler_plus(dv, dr, -1.0 / T));
        dv_sf_w = sculler_plus(sculler_plus(dv, lag, -1.0), twice, 1.0 / 6.0);
    } else {
        dv_sf_w = sculler_plus(sculler_plus(dv, once, -0.5), twice, 1.0 / 12.0);
    }
    sculler_vector v = sculler_plus(
        sculler_plus(sculler_plus(nav->v, dv_sf_w, 1.0), dv_g_cor, 1.0), damped, 1.0);
    if (!increments->displaced) {
        *moved = sculler_plus(sculler_times(0.5 * T, v), nav->v, 0.5 * T);
    }
    return v;
}

/* Carry the state over one major interval: velocity, position, then attitude. */
static void step(sculler_nav *nav, const sculler_increments *increments)
{
    const sculler_damping *loop = &nav->settings.damping;
    sculler_real T = nav->settings.interval, j = (sculler_real)nav->settings.position_every;

    /* the middle of the interval, by extrapolation (Savage-98 Eq. 8, 9, 19) */
    sculler_earth mid = between(&nav->earth, &nav->past, -((sculler_real)nav->since + 0.5) / j);
    sculler_real too_high = 0.0; /* against the height that the navigator had when it was measured */
    if (nav->age >= 0.0) {
        too_high = nav->h + nav->climb - nav->reference + nav->v.z * nav->age;
    }
    sculler_real offset = nav->offset + T * loop->k3 * too_high;
    sculler_real damped = T * (loop->k2 * too_high + offset);
    sculler_vector moved;
    sculler_vector v = carried(nav, &mid, damped, increments, &moved);

    /* position: what the displacement turns w by (Eq. 71-73) */
    sculler_vector xi = travelled(mid.curvature, moved);
    nav->travel = sculler_plus(nav->travel, xi, 1.0);
    nav->climb = nav->climb - moved.z - T * loop->k1 * too_high;

    /* attitude: q_wb(new) = q(-zeta) q_wb(old) q(phi) (Savage-20 Eq. 1) */
    sculler_vector turn = sculler_plus(xi, mid.rate, T);
    sculler_quaternion back = sculler_from_rotation_vector(sculler_times(-1.0, turn));
    sculler_quaternion body =
        sculler_product(nav->q, sculler_from_rotation_vector(increments->phi));
    nav->q = sculler_normalised(sculler_product(back, body));
    nav->v_past = nav->v;
    nav->v = v;
    nav->offset = offset;
    nav->since += 1u;

    if (nav->since >= nav->settings.position_every) {
        sculler_real h;
        nav->place = position(nav, &h);
        nav->h = h;
        nav->past = nav->earth;
        nav->earth = earth_at(nav->place, h, &nav->settings.gravity);
        nav->since = 0;
        nav->travel = sculler_nothing();
        nav->climb = 0.0;
    }
}

/* Before the first interval: the past that straight lines through it and the next one give. */
static void see_to_the_past(sculler_nav *nav, const sculler_increments *increments)
{
    sculler_nav after = *nav;
    step(&after, increments);
    sculler_real h;
    sculler_quaternion place = position(&after, &h);
    sculler_earth there = earth_at(place, h, &nav->settings.gravity);
    nav->v_past =
        sculler_plus(nav->v, sculler_plus(nav->v, after.v, -1.0), 1.0);
    nav->past = between(&nav->earth, &there, -(sculler_real)nav->settings.position_every);
}

/* ---- the navigator -------------------------------------------------------------------------- */

sculler_settings sculler_defaults(sculler_real interval)
{
    sculler_settings settings;
    settings.interval = interval;
    settings.position_every = 1;
    settings.damping.k1 = 0.0;
    settings.damping.k2 = 0.0;
    settings.damping.k3 = 0.0;
    settings.damping.reference = 0.0;
    settings.damping.hold = HOLD;
    settings.damping.waits = false;
    settings.gravity.is_constant = false;
    settings.gravity.value = 0.0;
    settings.gravity.table = NULL;
    return settings;
}

sculler_damping sculler_height_damping(sculler_real reference, sculler_real seconds)
{
    sculler_real rate = 1.0 / seconds, lean;
    sculler_real instability = 2.0 * normal_gravity(0.0, 0.0, &lean) / SCULLER_SEMI_MAJOR_AXIS;
    sculler_damping damping;
    damping.k1 = 3.0 * rate;
    damping.k2 = 3.0 * (rate * rate) + instability;
    damping.k3 = rate * rate * rate;
    damping.reference = reference;
    damping.hold = HOLD;
    damping.waits = false;
    return damping;
}

static bool is_state(const sculler_state *s)
{
    sculler_real sum = s->time + s->v.x + s->v.y + s->v.z + s->lat + s->lon + s->h + s->wander;
    sculler_real length = sqrt(s->q.w * s->q.w + s->q.x * s->q.x + s->q.y * s->q.y + s->q.z * s->q.z);
    return isfinite(sum) && fabs(s->lat) <= 0.5 * SCULLER_PI && fabs(s->lon) <= SCULLER_PI
           && fabs(s->wander) <= SCULLER_PI && MIN_HEIGHT <= s->h && s->h <= MAX_HEIGHT
           && fabs(length - 1.0) <= 1e-6;
}

static bool is_damped(const sculler_damping *loop)
{
    return loop->k1 != 0.0 || loop->k2 != 0.0 || loop->k3 != 0.0;
}

static bool are_settings(const sculler_settings *s)
{
    const sculler_damping *loop = &s->damping;
    bool damped = is_damped(loop);
    if (!(isfinite(s->interval) && s->interval > 0.0) || s->position_every < 1u) {
        return false;
    }
    /* k1 = 3/seconds, and the loop is to be slow against the intervals */
    return !damped || (loop->k1 > 0.0 && loop->k1 * s->interval <= 0.3 * (1.0 + 1e-12));
}

sculler_error sculler_nav_begin(
    sculler_nav *nav, const sculler_settings *settings, const sculler_state *start)
{
    if (!is_state(start)) {
        return SCULLER_BAD_STATE;
    }
    if (!are_settings(settings)) {
        return SCULLER_BAD_SETTING;
    }
    if (!covers(&settings->gravity, start->lat, start->h)) {
        return SCULLER_OUTSIDE;
    }
    sculler_quaternion to_level = sculler_about_z(-start->wander);
    nav->settings = *settings;
    nav->place = place_at(start->lat, start->lon, start->wander);
    nav->v = sculler_rotate(to_level, start->v);
    nav->v_past = nav->v;
    nav->h = start->h;
    nav->earth = earth_at(nav->place, start->h, &settings->gravity);
    nav->past = nav->earth;
    nav->q = sculler_normalised(sculler_product(to_level, start->q));
    nav->since = 0;
    nav->travel = sculler_nothing();
    nav->climb = 0.0;
    nav->offset = 0.0;
    nav->reference = settings->damping.waits ? 0.0 : settings->damping.reference;
    nav->age = settings->damping.waits ? -1.0 : 0.0;
    nav->measured = false;
    nav->start = start->time;
    nav->updates = 0;
    nav->begun = false;
    return SCULLER_OK;
}

/* A height that is too old is none. */
static void hold_to(sculler_nav *nav, sculler_real height, sculler_real age)
{
    bool fresh = age >= 0.0 && age <= nav->settings.damping.hold;
    nav->reference = fresh ? height : 0.0;
    nav->age = fresh ? age : -1.0;
}

sculler_error sculler_nav_hold_height(sculler_nav *nav, sculler_real height, sculler_real age)
{
    if (!is_damped(&nav->settings.damping) || !isfinite(age)
        || !(MIN_HEIGHT <= height && height <= MAX_HEIGHT)) {
        return SCULLER_BAD_SETTING;
    }
    nav->measured = true;
    hold_to(nav, height, age);
    return SCULLER_OK;
}

static sculler_real sum_of(sculler_vector v)
{
    return v.x + v.y + v.z;
}

sculler_error sculler_nav_update(sculler_nav *nav, const sculler_increments *increments)
{
    sculler_real sum = sum_of(increments->phi) + sum_of(increments->dv_sf);
    if (increments->displaced) {
        sum += sum_of(increments->dr_sf);
    }
    if (!isfinite(sum)) {
        return SCULLER_NOT_FINITE;
    }
    if (!nav->begun) {
        see_to_the_past(nav, increments);
        nav->begun = true;
    }
    step(nav, increments);
    nav->updates += 1u;
    if (nav->measured && nav->age >= 0.0) {
        hold_to(nav, nav->reference, nav->age + nav->settings.interval);
    }

    sculler_real lat = 0.0, h = nav->since == 0u ? nav->h : nav->h + nav->climb;
    if (nav->settings.gravity.table != NULL) { /* only a table asks for the latitude */
        sculler_state state;
        sculler_nav_state(nav, &state);
        lat = state.lat;
    }
    return covers(&nav->settings.gravity, lat, h) ? SCULLER_OK : SCULLER_OUTSIDE;
}
