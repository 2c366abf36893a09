/* {{ title }}.
{% for note in block.notes %}
   Note: {{ note }}.
{% endfor %}

   One C99 file without allocation, in double, or in float with -DSEATSIM_FLOAT. Include it and use it as

     static Model m;
     model_reset(&m);                 parameters as in the scenario; change them in m.parameters
     model_start(&m);                 with the inputs at time zero
     every STEP seconds:  set m.inputs, then  model_advance(&m, STEP);  model_observe(&m);  read m.outputs

   Inputs:
{% for v in inputs %}
     m.{{ "%-32s %-8s %s" | format(v.place, v.unit, v.meaning) }}
{% endfor %}
   Outputs:
{% for v in outputs %}
     m.{{ "%-32s %-8s %s" | format(v.place, v.unit, v.meaning) }}
{% endfor %}

   Compiled alone with -DSEATSIM_TEST -ffp-contract=off, and linked with -lm, it is a program that runs the test vector at
   its end and returns how many outputs are off. */
{{ model }}
#ifdef SEATSIM_TEST
#include <stdio.h>

#ifdef SEATSIM_FLOAT
#define TOLERANCE 1e-4 /* rounding decides how steps are divided, and what a force asks for that hardly depends on the current */
#else
#define TOLERANCE 1e-12
#endif

static const double fed[{{ samples }}][{{ inputs | length }}] = {
{% for row in fed %}
    {{ "{%s}," | format(row | join(", ")) }}
{% endfor %}
};
static const double expected[{{ samples }}][{{ outputs | length }}] = {
{% for row in expected %}
    {{ "{%s}," | format(row | join(", ")) }}
{% endfor %}
};

static double worst = 0.0;

/* Whether output j differs from what is expected by more than its greatest value permits. */
static int is_off(double got, double wanted, int j)
{
    double most = 0.0, error;
    for (int k = 0; k < {{ samples }}; k++) {
        most = fabs(expected[k][j]) > most ? fabs(expected[k][j]) : most;
    }
    error = most > 0.0 ? fabs(got - wanted) / most : fabs(got);
    worst = error > worst ? error : worst;
    return !(error <= TOLERANCE);
}

int main(void)
{
    static Model m;
    int off = 0;
    model_reset(&m);
    for (int k = 0; k < {{ samples }}; k++) {
{% for v in inputs %}
        m.{{ v.place }} = (real)fed[k][{{ loop.index0 }}];
{% endfor %}
        if (k == 0) {
            model_start(&m);
        }
        if (!model_advance(&m, STEP)) {
            off++;
        }
        model_observe(&m);
{% for v in outputs %}
        off += is_off(m.{{ v.place }}, expected[k][{{ loop.index0 }}], {{ loop.index0 }});
{% endfor %}
    }
    printf("%d of %d outputs are off; the greatest error is %.3g of its greatest value\n", off, {{ samples }} * {{ outputs | length }}, worst);
    return off > 0;
}
#endif
