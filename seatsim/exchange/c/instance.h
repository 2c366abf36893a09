/* One instance of the model behind either version of the interface. */
#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#if defined(_WIN32)
#define EXPORTED __declspec(dllexport)
#elif defined(__GNUC__)
#define EXPORTED __attribute__((visibility("default")))
#else
#define EXPORTED
#endif

#define VARIABLES (sizeof variables / sizeof variables[0])
#define ROUNDING 1e-6 /* share of a step by which a length may miss a whole number of steps */

typedef enum { INSTANTIATED, INITIALISING, STEPPING, ENDED } Phase;

/* Everything that a saved state holds. */
typedef struct {
    Model model;
    double time;
    int observed; /* whether the outputs are those of the present state and inputs */
    Phase phase;
} Content;

typedef struct {
    Content content;
    void (*tell)(void *instance, const char *text);
    char *name;
    void *environment;
    void (*logger)(void); /* of a type that the version of the interface knows */
} Instance;

static char *place_of(Content *c, unsigned int reference) { return (char *)&c->model + variables[reference].offset; }

/* Whether a reference is that of a variable of a kind. */
static int is_of(unsigned int reference, int kind) { return reference < VARIABLES && variables[reference].kind == kind; }

static void tell(Instance *i, const char *format, const char *name, double value, double low, double high)
{
    char text[512];
    snprintf(text, sizeof text, format, name, value, low, high);
    i->tell(i, text);
}

/* The kind is that of the caller: a number of its own for each, so that nothing is looked up twice. */
INLINED double read_number(Content *c, unsigned int reference, int kind)
{
    if (variables[reference].causality == OUTPUT && !c->observed) {
        model_observe(&c->model);
        c->observed = 1;
    }
    return kind == REAL_VARIABLE ? (double)*(real *)place_of(c, reference) : (double)*(int *)place_of(c, reference);
}

/* Set a parameter or an input; returns 0 where it is an output or the value is not permitted. */
INLINED int write_number(Instance *i, unsigned int reference, int kind, double value)
{
    const Variable *v = &variables[reference];
    Content *c = &i->content;
    if (v->causality == OUTPUT) {
        tell(i, "%s is an output and cannot be set (to %g)", v->name, value, 0.0, 0.0);
        return 0;
    }
    if (!(value >= v->low && value <= v->high)) {
        tell(i, "%s = %g is not permitted: it must be within %g and %g", v->name, value, v->low, v->high);
        return 0;
    }
    if (kind == REAL_VARIABLE) {
        *(real *)place_of(c, reference) = (real)value;
    } else {
        *(int *)place_of(c, reference) = (int)value;
    }
    c->observed = 0;
    if (v->causality == INPUT) {
        c->model.age = R(0.0);
    }
    return 1;
}

static void reset(Content *c)
{
    memset(c, 0, sizeof *c);
    model_reset(&c->model);
    c->phase = INSTANTIATED;
}

static void begin(Content *c, double time)
{
    model_start(&c->model);
    c->time = time;
    c->observed = 0;
    c->phase = INITIALISING;
}

/* End the initialisation; returns 0 where there was none. */
static int enter_steps(Instance *i)
{
    const int good = i->content.phase == INITIALISING;
    if (good) {
        begin(&i->content, i->content.time);
        i->content.phase = STEPPING;
    }
    return good;
}

/* Go on from one communication point to the next; returns 0 and says why where that is impossible. */
static int go_on(Instance *i, double from, double length)
{
    Content *c = &i->content;
    const double steps = length / STEP;
    if (!(length > 0.0)) {
        tell(i, "%s: a step of %g s is none; it must be above 0", i->name, length, 0.0, 0.0);
        return 0;
    }
    if (FIXED_STEP && !(steps < INT_MAX && fabs(steps - (int)(steps + 0.5)) <= ROUNDING * (1.0 + steps))) {
        tell(i, "%s: a step of %g s is not a whole number of steps of %g s", i->name, length, STEP, 0.0);
        return 0;
    }
    c->model.age = R(0.0);
    c->observed = 0;
    if (!model_advance(&c->model, (real)length)) {
        tell(i, "%s: no solution beyond %g s, where it leaves all bounds", i->name, from, 0.0, 0.0);
        return 0;
    }
    c->time = from + length;
    return 1;
}

static Instance *make_instance(const char *name)
{
    Instance *i = calloc(1, sizeof *i);
    char *copy = malloc(strlen(name) + 1);
    if (!i || !copy) {
        free(i);
        free(copy);
        return NULL;
    }
    strcpy(copy, name);
    i->name = copy;
    reset(&i->content);
    return i;
}

static void drop_instance(Instance *i)
{
    if (i) {
        free(i->name);
        free(i);
    }
}

/* Copy what an instance holds to a state, which is made where there is none; returns 0 where there is no memory. */
static int save_state(Instance *i, void **state)
{
    if (!*state) {
        *state = malloc(sizeof(Content));
    }
    if (*state) {
        memcpy(*state, &i->content, sizeof(Content));
    }
    return *state != NULL;
}

static void restore_state(Instance *i, const void *state) { memcpy(&i->content, state, sizeof(Content)); }

static void drop_state(void **state)
{
    free(*state);
    *state = NULL;
}

static int write_state(const void *state, void *bytes, size_t size)
{
    if (size >= sizeof(Content)) {
        memcpy(bytes, state, sizeof(Content));
    }
    return size >= sizeof(Content);
}

static int read_state(Instance *i, const void *bytes, size_t size, void **state)
{
    const int good = size == sizeof(Content) && save_state(i, state);
    if (good) {
        memcpy(*state, bytes, size);
    }
    return good;
}

#if defined(__GNUC__)
/* For what follows, the interface: the standard says which parameters its functions have; not all are used. */
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif
