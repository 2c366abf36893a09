/* The variables that can be read and written from outside, by their number. */
#include <stddef.h>

enum { REAL_VARIABLE, INTEGER_VARIABLE, BOOLEAN_VARIABLE };
enum { PARAMETER, INPUT, OUTPUT };

typedef struct {
    const char *name;
    int kind;
    int causality;
    size_t offset;
    double low;
    double high;
    int rate; /* number of the input that is its rate of change, or -1 */
} Variable;

static const Variable variables[] = {
{% for v in variables %}
    {"{{ v.name }}", {{ kinds[loop.index0] }}, {{ v.causality | upper }}, offsetof(Model, {{ v.place }}), {{ limit(v.low) }}, {{ limit(v.high) }}, {{ rates[loop.index0] }}},
{% endfor %}
};
