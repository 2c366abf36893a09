/* The benchmark's run in C as one would write it without seatsim: plain Runge-Kutta 4, current as a state.
 *
 * No error estimate, no energies, nine recorded channels; damper, control law and inverse are those of loop.c. The
 * current follows the coil's equation inside the Runge-Kutta step instead of its exact solution.
 */
#include <math.h>

#include "inverse.h"

enum { STATES = 7, CHANNELS = 9 };

typedef struct {
    double frame_mass, driver_mass, suspension_stiffness, suspension_damping, cushion_stiffness, cushion_damping;
    double c0[4], c1[4], alpha[4], k0, k1, x0, f0, A, beta, gamma, n, law_end;
    double coil_rate, max_current, gain_displacement, gain_velocity, step, tolerance, temperature;
    long sample_every;
} Setup;

typedef struct {
    double x, v, xc, vc, y, z, i;
} State;

static inline double cubic(const double c[4], double i) { return c[0] + i * (c[1] + i * (c[2] + i * c[3])); }

static inline double damper_force(const Setup *p, double x, double v, double i, double y, double z, double *rate) {
    double held = i < p->law_end ? i : p->law_end;
    double c0 = cubic(p->c0, held), c1 = cubic(p->c1, held);
    *rate = (cubic(p->alpha, held) * z + p->k0 * (x - y) + c0 * v) / (c0 + c1);
    return c1 * *rate + p->k1 * (x - p->x0) + p->f0;
}

static inline State derivative(const Setup *p, State s, double floor, double command, double *force) {
    double flow;
    *force = damper_force(p, s.x, s.v, s.i, s.y, s.z, &flow);
    double cushion = p->cushion_stiffness * s.xc + p->cushion_damping * s.vc;
    double suspension = p->suspension_stiffness * s.x + p->suspension_damping * s.v;
    double frame = (cushion - suspension - *force) / p->frame_mass;
    double r = s.v - flow;
    double size = p->n == 2.0 ? s.z * s.z : pow(fabs(s.z), p->n);
    double dz = p->A * r - p->beta * r * size - p->gamma * fabs(r) * copysign(size, s.z);
    return (State){
        s.v, frame - floor, s.vc, -cushion / p->driver_mass - frame, flow, dz, p->coil_rate * (command - s.i)
    };
}

static inline State moved(State s, double h, State k) {
    return (State){
        s.x + h * k.x, s.v + h * k.v, s.xc + h * k.xc, s.vc + h * k.vc, s.y + h * k.y, s.z + h * k.z, s.i + h * k.i
    };
}

/* What an inverse is asked: the current at which the damper gives the wanted force in a state of the rig. */
typedef struct {
    const Setup *setup;
    State state;
    double wanted;
} Question;

static double miss(const void *question, double current) {
    const Question *q = question;
    double rate;
    return damper_force(q->setup, q->state.x, q->state.v, current, q->state.y, q->state.z, &rate) - q->wanted;
}

static double inverse(const Setup *p, double wanted, State s) {
    return wanted * s.v <= 0.0 ? 0.0 : search(miss, &(Question){p, s, wanted}, p->max_current);
}

/* Simulate from rest; return the number of samples. */
long run_loop(const Setup *p, long samples, const double *floor, double *out) {
    State s = {0};
    double command = 0.0, wanted = 0.0, h = p->step, force, unused;
    for (long k = 0; k < samples; k++) {
        if (k % p->sample_every == 0) {
            wanted = p->gain_displacement * s.x + p->gain_velocity * s.v;
            command = inverse(p, wanted, s);
        }
        State k1 = derivative(p, s, floor[k], command, &force);
        double *row = out + k * CHANNELS;
        row[0] = floor[k], row[1] = k1.v + floor[k], row[2] = k1.v + floor[k] + k1.vc, row[3] = s.x, row[4] = s.v;
        row[5] = force, row[6] = wanted, row[7] = s.i, row[8] = command;
        if (k == samples - 1) break;
        double middle = 0.5 * (floor[k] + floor[k + 1]);
        State k2 = derivative(p, moved(s, 0.5 * h, k1), middle, command, &unused);
        State k3 = derivative(p, moved(s, 0.5 * h, k2), middle, command, &unused);
        State k4 = derivative(p, moved(s, h, k3), floor[k + 1], command, &unused);
        s = moved(moved(moved(moved(s, h / 6.0, k1), h / 3.0, k2), h / 3.0, k3), h / 6.0, k4);
    }
    return samples;
}
