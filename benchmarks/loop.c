/* The benchmark's run in C: the algorithm of seatsim's kernel, written for this one rig.
 *
 * 2-DOF seat, modified Bouc-Wen damper with cubic current laws, sampled static output feedback through an inverse
 * searched over the current, first-order coil. Runge-Kutta 4 whose last derivative serves the next step and the error
 * test; energies and all recorded channels as in seatsim. Only effects that this rig has are written down.
 */
#include <math.h>

#include "inverse.h"

enum { STATES = 10, CHANNELS = 17 };

typedef struct {
    double frame_mass, driver_mass, suspension_stiffness, suspension_damping, cushion_stiffness, cushion_damping;
} Plant;

typedef struct {
    double c0[4], c1[4], alpha[4], k0, k1, x0, f0, A, beta, gamma, n, law_end;
} Damper;

typedef struct {
    Plant plant;
    Damper damper;
    double coil_rate, max_current, gain_displacement, gain_velocity, step, tolerance, temperature;
    long sample_every;
} Setup;

typedef struct {
    double s[STATES]; /* x, v, xc, vc, works of floor, damper, suspension and cushion, y, z */
} State;

typedef struct {
    double floor, rise, current, command, kept; /* kept: share of the distance to the command after half a step */
} Drive;

typedef struct {
    State state, rates;
    double damper_force, substep;
} Progress;

static inline double cubic(const double c[4], double i) { return c[0] + i * (c[1] + i * (c[2] + i * c[3])); }

static inline double power(double base, double exponent) {
    if (exponent == 2.0) return base * base;
    return exponent == 1.0 ? base : pow(base, exponent);
}

/* Return the rate y' of the inner displacement, and the force in N through `force`. */
static inline double flow(const Damper *d, double x, double v, double i, double y, double z, double *force) {
    double held = i < d->law_end ? i : d->law_end;
    double c0 = cubic(d->c0, held), c1 = cubic(d->c1, held);
    double rate = (cubic(d->alpha, held) * z + d->k0 * (x - y) + c0 * v) / (c0 + c1);
    *force = c1 * rate + d->k1 * (x - d->x0) + d->f0;
    return rate;
}

static inline double force_at(const Damper *d, double x, double v, double i, const State *q) {
    double force;
    flow(d, x, v, i, q->s[8], q->s[9], &force);
    return force;
}

static inline double hysteresis(const Damper *d, double r, double z) {
    double size = power(fabs(z), d->n);
    return d->A * r - d->beta * r * size - d->gamma * fabs(r) * copysign(size, z);
}

static inline State derivative(const Setup *p, const State *q, double floor, double current, double *damper_force) {
    const Plant *m = &p->plant;
    double x = q->s[0], v = q->s[1], xc = q->s[2], vc = q->s[3], force;
    double inner = flow(&p->damper, x, v, current, q->s[8], q->s[9], &force);
    double resistance = m->suspension_damping * v;
    double cushion = m->cushion_stiffness * xc + m->cushion_damping * vc;
    double frame = (cushion - m->suspension_stiffness * x - resistance - force) / m->frame_mass;
    *damper_force = force;
    return (State){{
        v, frame - floor, vc, -cushion / m->driver_mass - frame,
        -(m->frame_mass * v + m->driver_mass * (v + vc)) * floor, force * v, resistance * v,
        m->cushion_damping * vc * vc, inner, hysteresis(&p->damper, v - inner, q->s[9]),
    }};
}

static inline State moved(const State *q, double h, const State *k) {
    State r;
    for (int j = 0; j < STATES; j++) r.s[j] = q->s[j] + h * k->s[j];
    return r;
}

static inline double current_at(const Setup *p, const Drive *d, double time) {
    return d->command + (d->current - d->command) * exp(-p->coil_rate * time);
}

/* The coil current in the middle and at the end of a sub-step; a whole step needs no exponential. */
static inline void currents(const Setup *p, const Drive *d, double time, double h, double *middle, double *end) {
    if (h < p->step) {
        *middle = current_at(p, d, time + 0.5 * h);
        *end = current_at(p, d, time + h);
    } else {
        *middle = d->command + (d->current - d->command) * d->kept;
        *end = d->command + (*middle - d->command) * d->kept;
    }
}

/* One Runge-Kutta step of `h` from `time`; return the error in units of the tolerance. */
static inline double try_step(
    const Setup *p, const Drive *d, const Progress *now, double time, double h, Progress *next, double *i_end
) {
    double middle = d->floor + d->rise * (time + 0.5 * h) / p->step;
    double end = d->floor + d->rise * (time + h) / p->step;
    double i_middle, force;
    currents(p, d, time, h, &i_middle, i_end);
    State k1 = now->rates;
    State a = moved(&now->state, 0.5 * h, &k1), k2 = derivative(p, &a, middle, i_middle, &force);
    State b = moved(&now->state, 0.5 * h, &k2), k3 = derivative(p, &b, middle, i_middle, &force);
    State c = moved(&now->state, h, &k3), k4 = derivative(p, &c, end, *i_end, &force);
    for (int j = 0; j < STATES; j++)
        next->state.s[j] = now->state.s[j] + h / 6.0 * (k1.s[j] + 2.0 * (k2.s[j] + k3.s[j]) + k4.s[j]);
    next->rates = derivative(p, &next->state, end, *i_end, &next->damper_force);
    double scale = p->tolerance * (0.01 + fabs(next->state.s[1]) + fabs(next->state.s[3]));
    return h / 6.0 * (fabs(k4.s[1] - next->rates.s[1]) + fabs(k4.s[3] - next->rates.s[3])) / scale;
}

static inline double longer(double h, double error, double length) {
    if (h >= length) return length;
    double factor = error < 1e-3 ? 4.0 : fmin(4.0, fmax(0.2, 0.9 / pow(error, 0.25)));
    return fmin(h * factor, length);
}

/* Advance by one step of the loop; return 0 where no sub-step is short enough. */
static inline int advance(const Setup *p, const Drive *d, Progress *now, double *current) {
    double time = 0.0, h = now->substep, remaining = p->step, i_end;
    while (remaining > 0.0) {
        int last = h >= remaining * (1.0 - 1e-12);
        if (last) h = remaining;
        Progress next;
        double error = try_step(p, d, now, time, h, &next, &i_end);
        if (!(error <= 1.0) && h > p->step * 0x1p-26) {
            h *= error < 1e12 ? fmax(0.1, 0.9 / pow(error, 0.25)) : 0.1;
            continue;
        }
        if (!(error < 1e12)) return 0;
        time += h;
        *now = next;
        *current = i_end;
        remaining = last ? 0.0 : p->step - time;
        h = longer(h, error, p->step);
    }
    now->substep = h;
    return 1;
}

/* What an inverse is asked: the current at which the damper, in this motion and state, gives the wanted force. */
typedef struct {
    const Damper *damper;
    const State *state;
    double wanted, x, v;
} Question;

static double miss(const void *question, double current) {
    const Question *q = question;
    return force_at(q->damper, q->x, q->v, current, q->state) - q->wanted;
}

static inline void record(
    double *row, const Progress *now, double floor, double wanted, double served, double current, double command,
    double temperature
) {
    const double *s = now->state.s, *r = now->rates.s;
    row[0] = floor, row[1] = r[1] + floor, row[2] = r[1] + floor + r[3];
    row[3] = s[0], row[4] = s[1], row[5] = s[2], row[6] = s[3];
    row[7] = now->damper_force, row[8] = wanted, row[9] = served;
    row[10] = current, row[11] = command, row[12] = temperature;
    row[13] = s[4], row[14] = s[5], row[15] = s[6], row[16] = s[7];
}

/* Simulate from rest; return the number of samples reached. */
long run_loop(const Setup *p, long samples, const double *floor, double *out) {
    Progress now = {.substep = p->step};
    double current = 0.0, command = 0.0, wanted = NAN, served = NAN, kept = exp(-0.5 * p->coil_rate * p->step);
    now.rates = derivative(p, &now.state, floor[0], current, &now.damper_force);
    for (long k = 0; k < samples; k++) {
        if (k % p->sample_every == 0) {
            double x = now.state.s[0], v = now.state.s[1];
            wanted = p->gain_displacement * x + p->gain_velocity * v;
            command = wanted * v <= 0.0 ? 0.0 : search(miss, &(Question){&p->damper, &now.state, wanted, x, v}, p->max_current);
            double got = force_at(&p->damper, x, v, command, &now.state);
            served = fabs(got - wanted) <= 1e-6 * (1.0 + fabs(wanted)) ? 1.0 : 0.0;
            command = fmin(fmax(command, 0.0), p->max_current);
        }
        record(out + k * CHANNELS, &now, floor[k], wanted, served, current, command, p->temperature);
        if (k == samples - 1) break;
        Drive drive = {floor[k], floor[k + 1] - floor[k], current, command, kept};
        if (!advance(p, &drive, &now, &current)) return k;
    }
    return samples;
}
