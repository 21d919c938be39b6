/* The rows of a block array, end to end, where they are. */
#include "core.h"

#include <string.h>

/* The caller's tuple keeps its arrays, so their buffers need not stay open: there may be thousands. */
Rope rope_of(Call *call, PyObject *arrays)
{
    Rope rope = {NULL, NULL, 0, 1, 0};
    int many = PyTuple_Check(arrays);
    Index count = many ? PyTuple_Size(arrays) : 1;
    expect(call, count > 0, "a block or more is wanted");
    rope.blocks = (const double **)index_scratch(call, count);
    rope.begins = index_scratch(call, count + 1);
    if (call->failed)
        return rope;
    rope.count = count;
    rope.begins[0] = 0;
    for (Index b = 0; b < count && !call->failed; b++) {
        PyObject *array = many ? PyTuple_GetItem(arrays, b) : arrays;
        int before = call->held;
        Table block = reals(call, array);
        expect(call, !many || call->held == before, "blocks must lie row after row");
        expect(call, block.rows > 0 && (!b || block.columns == rope.columns),
               "blocks must have rows, all of one length");
        rope.blocks[b] = block.at;
        rope.columns = block.columns;
        rope.begins[b + 1] = rope.begins[b] + block.rows;
        if (many && !call->failed)
            PyBuffer_Release(&call->views[--call->opened]);
    }
    return rope;
}

void rope_turn(Rope *rope, Index row)
{
    Index low = 0, high = rope->count - 1;
    while (low < high) {
        Index middle = low + (high - low + 1) / 2;
        if (rope->begins[middle] <= row)
            low = middle;
        else
            high = middle - 1;
    }
    rope->current = low;
}

const double *rope_rows(Rope *rope, Index first, Index count, double *room)
{
    const Index *begins = rope->begins;
    Index b = rope->current, d = rope->columns;
    if (first < begins[b] || first >= begins[b + 1]) {
        rope_turn(rope, first);
        b = rope->current;
    }
    if (first + count <= begins[b + 1])
        return rope->blocks[b] + (first - begins[b]) * d;
    double *next = room;
    for (Index row = first, stop; row < first + count; row = stop, b++) {
        stop = at_most(first + count, begins[b + 1]);
        memcpy(next, rope->blocks[b] + (row - begins[b]) * d,
               (size_t)((stop - row) * d) * sizeof(double));
        next += (stop - row) * d;
    }
    return room;
}
