/* The rows of a block array, end to end, where they are. */
#include "core.h"

#include <stdlib.h>
#include <string.h>

#define NAME "multirep.rope"

/* -- made once, kept as long as the blocks ------------------------------------------------------ */

/* Arrays that lie row after row, or ropes; they stay where they are while the tuple lives. */
typedef struct {
    Rope rope;
    PyObject *parts;
} Kept;

static const Rope *rope_in(PyObject *capsule)
{
    Kept *kept = PyCapsule_GetPointer(capsule, NAME);
    return kept ? &kept->rope : NULL;
}

static void release(PyObject *capsule)
{
    Kept *kept = PyCapsule_GetPointer(capsule, NAME);
    Py_DECREF(kept->parts);
    free(kept->rope.blocks);
    free(kept);
}

/* Room for so many blocks, in one piece. */
static Rope empty_rope(void *memory, Index count)
{
    Rope rope = {.blocks = memory, .columns = 1};
    rope.firsts = (double *)(rope.blocks + count);
    rope.begins = (Index *)(rope.firsts + count);
    return rope;
}

static size_t rope_size(Index count)
{
    return (size_t)count * (sizeof(double *) + sizeof(double)) + (size_t)(count + 1) * sizeof(Index);
}

static void append_block(Call *call, Rope *rope, const double *at, Index rows, Index columns)
{
    expect(call, rows > 0 && (!rope->count || columns == rope->columns),
           "blocks must have rows, all of one length");
    Index b = rope->count++, begin = b ? rope->begins[b] : 0;
    if (call->failed)
        return;
    rope->blocks[b] = at;
    rope->firsts[b] = at[0];
    rope->begins[b] = begin;
    rope->begins[b + 1] = begin + rows;
    rope->columns = columns;
}

/* Arrays of a tuple: it keeps them, so their buffers need not stay open, there may be thousands. */
static void append_array(Call *call, Rope *rope, PyObject *array)
{
    int held = call->held;
    Table block = reals(call, array);
    expect(call, call->held == held, "blocks must lie row after row");
    append_block(call, rope, block.at, block.rows, block.columns);
    if (!call->failed)
        PyBuffer_Release(&call->views[--call->opened]);
}

static void append_rope(Call *call, Rope *rope, const Rope *other)
{
    Index b = rope->count, more = other->count, begin = b ? rope->begins[b] : 0;
    expect(call, !b || other->columns == rope->columns, "blocks must have rows, all of one length");
    memcpy(rope->blocks + b, other->blocks, (size_t)more * sizeof(double *));
    memcpy(rope->firsts + b, other->firsts, (size_t)more * sizeof(double));
    for (Index k = 0; k <= more; k++)
        rope->begins[b + k] = begin + other->begins[k];
    rope->columns = other->columns;
    rope->count += more;
}

METHOD(core_rope)
{
    /* a tuple of arrays that lie row after row, or of ropes: one after the other; returns a rope */
    Call call;
    begin(&call, count, 1);
    expect(&call, call.failed || (PyTuple_Check(values[0]) && PyTuple_Size(values[0]) > 0),
           "a block or more is wanted");
    if (call.failed)
        return finish(&call, NULL);
    Index parts = PyTuple_Size(values[0]), blocks = 0;
    for (Index k = 0; k < parts && !call.failed; k++) {
        PyObject *part = PyTuple_GetItem(values[0], k);
        const Rope *rope = PyCapsule_CheckExact(part) ? rope_in(part) : NULL;
        call.failed |= PyErr_Occurred() != NULL;
        blocks += rope ? rope->count : 1;
    }
    Kept *kept = call.failed ? NULL : malloc(sizeof(Kept));
    void *memory = kept ? malloc(rope_size(blocks)) : NULL;
    if (!memory && !call.failed) {
        PyErr_NoMemory();
        call.failed = 1;
    }
    if (memory)
        *kept = (Kept){empty_rope(memory, blocks), values[0]};
    for (Index k = 0; k < parts && !call.failed; k++) {
        PyObject *part = PyTuple_GetItem(values[0], k);
        const Rope *rope = PyCapsule_CheckExact(part) ? rope_in(part) : NULL;
        if (rope)
            append_rope(&call, &kept->rope, rope);
        else
            append_array(&call, &kept->rope, part);
    }
    PyObject *capsule = call.failed ? NULL : PyCapsule_New(kept, NAME, release);
    if (capsule)
        Py_INCREF(kept->parts);
    else {
        free(memory);
        free(kept);
    }
    return finish(&call, capsule);
}

/* -- for one call ------------------------------------------------------------------------------- */

Rope rope_of(Call *call, PyObject *arrays)
{
    Rope none = {.columns = 1};
    if (call->failed)
        return none;
    if (PyCapsule_CheckExact(arrays)) {
        const Rope *kept = rope_in(arrays);
        call->failed |= !kept;
        return kept ? *kept : none;
    }
    int many = PyTuple_Check(arrays);
    Index count = many ? PyTuple_Size(arrays) : 1;
    expect(call, count > 0, "a block or more is wanted");
    void *memory = scratch(call, (Index)(rope_size(count) / sizeof(double)) + 1);
    if (call->failed)
        return none;
    Rope rope = empty_rope(memory, count);
    if (!many) {
        Table block = reals(call, arrays);
        append_block(call, &rope, block.at, block.rows, block.columns);
    }
    for (Index b = 0; many && b < count && !call->failed; b++)
        append_array(call, &rope, PyTuple_GetItem(arrays, b));
    return rope;
}

void rope_turn(Rope *rope, Index row)
{
    const Index *begins = rope->begins;
    Index low = 0, high = rope->count - 1;
    /* first where it would be if all blocks were equally long, which they nearly are */
    Index middle = (Index)((double)row / (double)begins[rope->count] * (double)rope->count);
    while (low < high) {
        if (begins[middle] <= row)
            low = middle;
        else
            high = middle - 1;
        if (row < begins[low + 1])
            break;
        middle = low + (high - low + 1) / 2;
    }
    rope->current = low;
}

const double *rope_rows_elsewhere(Rope *rope, Index first, Index count, double *room)
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
