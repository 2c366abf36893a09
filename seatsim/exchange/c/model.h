#define STEP R({{ block.step }})
#define FIXED_STEP {{ block.fixed_step | int }}

/* The model: its numbers, and what can be done with it. Nothing is allocated. */
typedef struct {
    {{ Parameters }} parameters;
    {{ Inputs }} inputs;
    {{ State }} state;
    {{ Outputs }} outputs;
    real age; /* s since the inputs were given */
} Model;

/* Put parameters and inputs back to those of the scenario. */
static inline void model_reset(Model *m)
{
    m->parameters = nominal_parameters;
    m->inputs = first_inputs;
    m->state = rest_state;
    m->age = R(0.0);
}

/* Begin at time zero with the parameters and inputs that are set. */
static inline void model_start(Model *m)
{
    m->state = {{ START }};
    m->age = R(0.0);
}

/* Go on by a length of time in s, step by step where steps are fixed; returns 0 where the solution left all bounds, and
   then stays at the last step that was reached. */
static inline int model_advance(Model *m, real length)
{
    const int steps = FIXED_STEP ? greatest_int(1, (int)(length / STEP + R(0.5))) : 1;
    const real part = FIXED_STEP ? STEP : length;
    for (int k = 0; k < steps; k++) {
        const {{ Advanced }} next = {{ ADVANCE }};
        if (!next.item1) {
            return 0;
        }
        m->state = next.item0;
    }
    m->age = length;
    return 1;
}

/* Compute the outputs. */
static inline void model_observe(Model *m)
{
    m->outputs = {{ OBSERVE }};
}
