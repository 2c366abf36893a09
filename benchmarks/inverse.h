/* Inverse of a damper: the least current at which its force is the wanted one, or else comes closest to it.
 *
 * `miss` returns the force less the wanted one, in N, at a current. It is searched on a grid of currents, and bracketed
 * where it changes its sign; see seatsim/kernel/inverse.py.
 */
#include <math.h>

enum { CELLS = 16, TRIALS = 60 };
/* In cells from an end of the grid; in N; from a turn, over the width of its interval. */
static const double INSIDE = 1e-4, CLOSE = 1e-6, BESIDE = 1e-2;

typedef double (*Miss)(const void *question, double current);

/* Root in [left, right] by the Illinois method, until no number is left between the ends. */
static double bracket(Miss miss, const void *question, double left, double f_left, double right, double f_right) {
    int side = 0;
    double middle = right;
    for (int trial = 0; trial < TRIALS; trial++) {
        middle = (left * f_right - right * f_left) / (f_right - f_left);
        if (!(left < middle && middle < right)) break;
        double f = miss(question, middle);
        if (f == 0.0) break;
        if (f * f_left > 0.0) {
            left = middle, f_left = f;
            if (side == -1) f_right *= 0.5;
            side = -1;
        } else {
            right = middle, f_right = f;
            if (side == 1) f_left *= 0.5;
            side = 1;
        }
    }
    return fmin(fmax(middle, left), right);
}

/* Whether the force comes closest to the wanted one, or passes it, about point `j` of the grid. */
static int turns_near(Miss miss, const void *question, double top, const double *grid, double side, int j) {
    double here = side * grid[j];
    if (j > 0 && side * grid[j - 1] <= here) return 0;
    if (j < CELLS && side * grid[j + 1] < here) return 0;
    if (0 < j && j < CELLS) return 1;
    double near = side * miss(question, top * (j == 0 ? INSIDE : CELLS - INSIDE) / CELLS);
    return j == 0 ? near < here : near <= here;
}

/* Current at the vertex of the parabola through the forces at `i` and `beside` it on either side. */
static double turn_at(Miss miss, const void *question, double i, double beside) {
    double before = miss(question, i - beside), here = miss(question, i), after = miss(question, i + beside);
    double bend = (after - here) - (here - before);
    return fabs(after - before) >= fabs(bend) ? i : i - 0.5 * beside * (after - before) / bend;
}

/* Least current in [left, right] whose force is closest to the wanted one, by golden section. */
static double closest_in(Miss miss, const void *question, double side, double left, double right, double *missed) {
    const double golden = 0.5 * (sqrt(5.0) - 1.0);
    double first = left, last = right, beside = BESIDE * (right - left);
    double low = right - golden * (right - left), high = left + golden * (right - left);
    double f_low = miss(question, low), f_high = miss(question, high);
    for (int trial = 0; trial < TRIALS; trial++) {
        if (side * f_low < 0.0) return *missed = f_low, low;
        if (side * f_low <= side * f_high) {
            right = high, high = low, f_high = f_low;
            low = right - golden * (right - left), f_low = miss(question, low);
        } else {
            left = low, low = high, f_low = f_high;
            high = left + golden * (right - left), f_high = miss(question, high);
        }
    }
    double turn = turn_at(miss, question, high, fmin(beside, fmin(high - first, last - high)));
    double f_turn = miss(question, turn);
    if (side * (f_turn - f_high) <= CLOSE) return *missed = f_turn, turn;
    return *missed = f_high, high;
}

/* Least current in [0, top] that gives the wanted force, or else comes closest to it. */
static double search(Miss miss, const void *question, double top) {
    double grid[CELLS + 1];
    for (int j = 0; j <= CELLS; j++) grid[j] = miss(question, top * j / CELLS);
    double best = 0.0, closest = fabs(grid[0]), side = copysign(1.0, grid[0]);
    for (int j = 0; j <= CELLS && closest > CLOSE; j++) {
        int before = j > 0 ? j - 1 : 0, after = j < CELLS ? j + 1 : CELLS;
        double left = top * before / CELLS, current = top * j / CELLS, missed = grid[j];
        if (j > 0 && side * grid[j] < 0.0) return bracket(miss, question, left, grid[before], current, grid[j]);
        if (turns_near(miss, question, top, grid, side, j)) {
            current = closest_in(miss, question, side, left, top * after / CELLS, &missed);
            if (side * missed < 0.0) return bracket(miss, question, left, grid[before], current, missed);
        }
        if (fabs(missed) < closest) best = current, closest = fabs(missed);
    }
    return best;
}
