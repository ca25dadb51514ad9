/* The distinct ones of some numbers, sorted, and where each stands among them, by a table.  Numbers
   are not negative.  A function that finds no memory returns -1. */

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "pas.h"

/* Places in `found` of numbers by their hashes, -1 where there is none; there are 2^(64 - shift) slots. */
typedef struct {
    whole *slots, *found, number, room;
    int shift;
} Table;

static inline size_t slot_of(uint64_t key, int shift) { return (size_t)(key * UINT64_C(0x9E3779B97F4A7C15) >> shift); }

static int grown(Table *t)
{
    const size_t slots = (size_t)1 << (64 - t->shift + 1);
    whole *table = malloc(slots * sizeof(whole)), *found = realloc(t->found, (slots / 2 + 1) * sizeof(whole));
    if (found) t->found = found;
    if (!table || !found) {
        free(table);
        return -1;
    }
    free(t->slots);
    t->slots = table;
    t->shift--;
    t->room = (whole)(slots / 2);
    memset(table, -1, slots * sizeof(whole));
    for (whole i = 0; i < t->number; i++) {
        size_t at = slot_of((uint64_t)t->found[i], t->shift);
        while (table[at] >= 0) at = (at + 1) & (slots - 1);
        table[at] = i;
    }
    return 0;
}

/* Sort numbers, and places with them, by eleven bits at a time. */
static void sorted(whole *keys, whole *places, whole count, whole *other_keys, whole *other_places)
{
    uint64_t all = 0;
    for (whole i = 0; i < count; i++) all |= (uint64_t)keys[i];
    for (int low = 0; low < 64 && all >> low; low += 11) {
        whole first[2049] = {0};
        for (whole i = 0; i < count; i++) first[((uint64_t)keys[i] >> low & 2047) + 1]++;
        for (int k = 0; k < 2048; k++) first[k + 1] += first[k];
        for (whole i = 0; i < count; i++) {
            const whole at = first[(uint64_t)keys[i] >> low & 2047]++;
            other_keys[at] = keys[i];
            other_places[at] = places[i];
        }
        memcpy(keys, other_keys, count * sizeof(whole));
        memcpy(places, other_places, count * sizeof(whole));
    }
}

/* The distinct ones of `keys` (count) into `distinct`, sorted, and where each of them stands into `inverse` (count),
   if that is `wanted`; how many there are into `number`. */
int pas_numbered(whole count, const whole *keys, whole wanted, whole *distinct, whole *inverse, whole *number)
{
    Table t = {NULL, NULL, 0, 0, 54};
    int state = grown(&t);
    for (whole i = 0; state == 0 && i < count; i++) {
        if (t.number == t.room && (state = grown(&t)) != 0) break;
        const size_t last = ((size_t)1 << (64 - t.shift)) - 1;
        size_t at = slot_of((uint64_t)keys[i], t.shift);
        while (t.slots[at] >= 0 && t.found[t.slots[at]] != keys[i]) at = (at + 1) & last;
        if (t.slots[at] < 0) {
            t.found[t.number] = keys[i];
            t.slots[at] = t.number++;
        }
        if (wanted) inverse[i] = t.slots[at];
    }
    whole *room = state == 0 ? malloc((4 * t.number + 1) * sizeof(whole)) : NULL;
    if (room) {
        whole *places = room + t.number, *back = room;
        for (whole i = 0; i < t.number; i++) places[i] = i;
        sorted(t.found, places, t.number, room + 2 * t.number, room + 3 * t.number);
        memcpy(distinct, t.found, t.number * sizeof(whole));
        for (whole i = 0; i < t.number; i++) back[places[i]] = i;
        for (whole i = 0; wanted && i < count; i++) inverse[i] = back[inverse[i]];
        *number = t.number;
    } else
        state = -1;
    free(room);
    free(t.slots);
    free(t.found);
    return state;
}
