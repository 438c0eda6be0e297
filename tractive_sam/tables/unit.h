/* Variables of a unit and their derivatives, for every version of the interface: forces and their
   derivatives are outputs that follow from the inputs at once; there are no states. The including
   file defines Logger. Written by tractive_sam. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "@NAME@.h"

#define INPUTS @COUNT@
#define CREEPAGES 3
#define FORCES 3
#define OUTPUTS 12

static const double starts[INPUTS] = {@STARTS@};

typedef struct {
    double value[INPUTS + OUTPUTS];
    int known; /* whether the outputs are those of the inputs */
    Logger logger;
    void *environment;
    char name[128];
} Unit;

/* All functions below return NULL, or the reason of a failure. */
static const char *forces(const double *input, double *output) {
    static const char *const reasons[] = {
        NULL, "a creepage is no number, or several are infinite",
        "a property of the contact is not positive and finite", "a/b is outside the table",
        "a value is outside the table"
    };
    return reasons[@NAME@(@GIVEN@, output, output + FORCES)];
}

static const char *evaluate(Unit *unit) {
    const char *reason = unit->known ? NULL : forces(unit->value, unit->value + INPUTS);
    unit->known = !reason;
    return reason;
}

static void reset(Unit *unit) {
    memcpy(unit->value, starts, sizeof starts);
    unit->known = 0;
}

static Unit *instantiate(const char *name, const char *token) {
    Unit *unit;
    if (!token || strcmp(token, "@TOKEN@")) return NULL;
    unit = calloc(1, sizeof *unit);
    if (!unit) return NULL;
    if (name) strncpy(unit->name, name, sizeof unit->name - 1);
    reset(unit);
    return unit;
}

static const char *get(Unit *unit, const unsigned at[], size_t n, double value[]) {
    size_t k;
    for (k = 0; k < n; k++) {
        const char *reason = at[k] >= INPUTS + OUTPUTS ? "there is no such variable" : NULL;
        if (!reason && at[k] >= INPUTS) reason = evaluate(unit);
        if (reason) return reason;
        value[k] = unit->value[at[k]];
    }
    return NULL;
}

static const char *set(Unit *unit, const unsigned at[], size_t n, const double value[]) {
    size_t k;
    for (k = 0; k < n; k++) {
        if (at[k] >= INPUTS) return "there is no such input";
        unit->value[at[k]] = value[k];
        unit->known = 0;
    }
    return NULL;
}

/* Derivatives of all outputs by an input: of forces by creepages those of the table, others by
   central differences, at the limits of the table by one-sided ones. */
static const char *differentiate(Unit *unit, unsigned by, double slope[OUTPUTS]) {
    double input[INPUTS], ends[2][OUTPUTS], place[2];
    const double here = unit->value[by];
    const double step = here != 0.0 ? 1e-6 * fabs(here) : 1e-9;
    const char *reason = evaluate(unit);
    int k, side;
    if (reason) return reason;
    memcpy(input, unit->value, sizeof input);
    for (side = 0; side < 2; side++) {
        input[by] = place[side] = side ? here + step : here - step;
        if (forces(input, ends[side])) {
            place[side] = here;
            memcpy(ends[side], unit->value + INPUTS, sizeof ends[side]);
        }
    }
    if (place[0] == place[1]) return "the table has one value of this input";
    for (k = 0; k < OUTPUTS; k++) slope[k] = (ends[1][k] - ends[0][k]) / (place[1] - place[0]);
    for (k = 0; by < CREEPAGES && k < FORCES; k++)
        slope[k] = unit->value[INPUTS + FORCES + CREEPAGES * k + by];
    return NULL;
}

static const char *directional(Unit *unit, const unsigned of[], size_t n_of, const unsigned by[],
                               size_t n_by, const double seed[], double value[]) {
    size_t i, k;
    for (i = 0; i < n_of; i++) value[i] = 0.0;
    for (k = 0; k < n_by; k++) {
        double slope[OUTPUTS];
        const char *reason = by[k] >= INPUTS ? "there is no such input" : NULL;
        if (!reason) reason = differentiate(unit, by[k], slope);
        if (reason) return reason;
        for (i = 0; i < n_of; i++) {
            if (of[i] < INPUTS || of[i] >= INPUTS + OUTPUTS) return "there is no such output";
            value[i] += seed[k] * slope[of[i] - INPUTS];
        }
    }
    return NULL;
}
