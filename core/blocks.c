/* Block arrays: which block has a row, where a value belongs, what versions share, and versions with
another block. An array is a tuple of runs, a run is a tuple of blocks; see multirep.runs. */
#include "core.h"

#include <string.h>

static Index items(Call *call, PyObject *tuple)
{
    expect(call, call->failed || PyTuple_Check(tuple), "tuples of runs of blocks are wanted");
    return call->failed ? 0 : PyTuple_Size(tuple);
}

/* Borrowed; an error where there is none. */
static PyObject *item(Call *call, PyObject *tuple, Index k)
{
    expect(call, call->failed || PyTuple_Check(tuple), "tuples of runs of blocks are wanted");
    PyObject *found = call->failed ? NULL : PyTuple_GetItem(tuple, k);
    call->failed |= !found;
    return found;
}

static Index rows_in(Call *call, PyObject *block)
{
    Index rows = call->failed ? 0 : PyObject_Size(block);
    call->failed |= rows < 0;
    return rows;
}

static Index end_of_run(Call *call, PyObject *ends, Index g)
{
    return g < 0 ? 0 : integer(call, item(call, ends, g));
}

METHOD(core_place)
{
    /* runs, where they end, a row; returns the block that has it, the first row of that, the number
    of its run and its number there. The row after the last belongs to the last block. */
    Call call;
    begin(&call, count, 3);
    if (call.failed)
        return finish(&call, NULL);
    PyObject *ends = values[1];
    Index row = integer(&call, values[2]), g = 0, last = items(&call, values[0]) - 1;
    while (g < last && end_of_run(&call, ends, g) <= row && !call.failed)
        g++;
    PyObject *run = item(&call, values[0], g);
    Index k = 0, first = end_of_run(&call, ends, g - 1), final = items(&call, run) - 1;
    PyObject *block = item(&call, run, 0);
    while (k < final && !call.failed) {
        Index rows = rows_in(&call, block);
        if (row < first + rows)
            break;
        first += rows;
        block = item(&call, run, ++k);
    }
    return finish(&call, call.failed ? NULL : Py_BuildValue("Onnn", block, first, g, k));
}

/* The numbers of a block; its buffer need not stay open, for the caller's tuple keeps it. */
static Table numbers_of(Call *call, PyObject *block)
{
    int before = call->held;
    Table found = call->failed ? (Table){NULL, 0, 0} : reals(call, block);
    expect(call, call->held == before && found.rows > 0 && found.columns == 1,
           "blocks must be numbers in a row");
    if (!call->failed)
        PyBuffer_Release(&call->views[--call->opened]);
    return found;
}

static int is_before(double number, double value, int right)
{
    return right ? !(value < number) : number < value;
}

/* The first of some items, blocks or runs of them, whose last number is not before a value; the
last item where there is none. */
static Index first_reaching(Call *call, PyObject *tuple, int of_runs, double value, int right)
{
    Index low = 0, high = items(call, tuple) - 1;
    while (low < high && !call->failed) {
        Index middle = (low + high) / 2;
        PyObject *block = item(call, tuple, middle);
        if (of_runs)
            block = item(call, block, items(call, block) - 1);
        Table numbers = numbers_of(call, block);
        if (!call->failed && is_before(numbers.at[numbers.rows - 1], value, right))
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

METHOD(core_searched)
{
    /* runs of ascending numbers, where they end, a value, whether behind equal numbers; returns the
    row before which the value belongs */
    Call call;
    begin(&call, count, 4);
    if (call.failed)
        return finish(&call, NULL);
    double value = real(&call, values[2]);
    int right = values[3] == Py_True;
    Index g = first_reaching(&call, values[0], 1, value, right);
    PyObject *run = item(&call, values[0], g);
    Index k = first_reaching(&call, run, 0, value, right);
    Table numbers = numbers_of(&call, item(&call, run, k));
    if (call.failed)
        return finish(&call, NULL);
    Index low = 0, high = numbers.rows;
    while (low < high) {
        Index middle = (low + high) / 2;
        if (is_before(numbers.at[middle], value, right))
            low = middle + 1;
        else
            high = middle;
    }
    low += end_of_run(&call, values[1], g - 1);
    for (Index before = 0; before < k; before++)
        low += rows_in(&call, item(&call, run, before));
    return finish(&call, call.failed ? NULL : PyLong_FromSsize_t(low));
}

/* A tuple of the same type with one item exchanged. */
static PyObject *exchanged(Call *call, PyObject *tuple, Index k, PyObject *other)
{
    Index size = items(call, tuple);
    expect(call, k >= 0 && k < size, "no such block");
    PyObject *made = NULL;
    if (!call->failed)
        made = PyTuple_CheckExact(tuple) ? PyTuple_New(size)
                                         : PyType_GenericAlloc(Py_TYPE(tuple), size);
    call->failed |= !made;
    for (Index i = 0; i < size && !call->failed; i++)
        PyTuple_SetItem(made, i, Py_NewRef(i == k ? other : PyTuple_GetItem(tuple, i)));
    return made;
}

METHOD(core_with_block)
{
    /* runs, where they end, the number of a run, of a block in it, another block; returns runs with
    that one in its place, and where they end */
    Call call;
    begin(&call, count, 5);
    if (call.failed)
        return finish(&call, NULL);
    PyObject *runs = values[0], *ends = values[1], *block = values[4];
    Index g = integer(&call, values[2]), k = integer(&call, values[3]);
    PyObject *run = item(&call, runs, g), *old = item(&call, run, k);
    Index size = items(&call, runs), more = rows_in(&call, block) - rows_in(&call, old);
    expect(&call, items(&call, ends) == size, "as many runs as ends are wanted");
    PyObject *new_run = exchanged(&call, run, k, block);
    PyObject *new_runs = exchanged(&call, runs, g, new_run);
    Py_XDECREF(new_run);
    PyObject *new_ends = call.failed ? NULL : more ? PyTuple_New(size) : Py_NewRef(ends);
    call.failed |= !new_ends;
    for (Index i = 0; i < size && more && !call.failed; i++) {
        PyObject *end = PyTuple_GetItem(ends, i);
        end = i < g ? Py_NewRef(end) : PyLong_FromSsize_t(integer(&call, end) + more);
        call.failed |= !end || PyTuple_SetItem(new_ends, i, end) < 0;
    }
    return finish(&call, pair_of(&call, new_runs, new_ends));
}

METHOD(core_joined)
{
    /* block, start, stop, rows that stand for its rows start .. stop - 1; the new block */
    Call call;
    begin(&call, count, 5);
    if (call.failed)
        return finish(&call, NULL);
    Table old = reals(&call, values[0]), rows = reals(&call, values[3]);
    Index start = integer(&call, values[1]), stop = integer(&call, values[2]);
    Table made = output(&call, values[4]);
    expect(&call,
           0 <= start && start <= stop && stop <= old.rows &&
               made.rows == old.rows - (stop - start) + rows.rows &&
               made.columns == old.columns && (!rows.rows || rows.columns == old.columns),
           "room for all rows is wanted");
    if (call.failed)
        return finish(&call, NULL);
    size_t row = (size_t)made.columns * sizeof(double);
    double *next = made.at;
    memcpy(next, old.at, (size_t)start * row);
    next += start * made.columns;
    if (rows.rows)
        memcpy(next, rows.at, (size_t)rows.rows * row);
    next += rows.rows * made.columns;
    memcpy(next, old.at + stop * old.columns, (size_t)(old.rows - stop) * row);
    return finish(&call, Py_NewRef(Py_None));
}

METHOD(core_shared_rows)
{
    /* runs, where they end, runs of another array, whether from the end; returns how many rows both
    have in the same blocks, up to the first that is not */
    Call call;
    begin(&call, count, 4);
    if (call.failed)
        return finish(&call, NULL);
    PyObject *arrays[2] = {values[0], values[2]};
    int from_end = values[3] == Py_True;
    Index runs[2] = {items(&call, arrays[0]), items(&call, arrays[1])};
    /* How many runs are passed, and how many blocks of the next. */
    Index passed[2] = {0, 0}, blocks[2] = {0, 0}, rows = 0;
    while (!call.failed && passed[0] < runs[0] && passed[1] < runs[1]) {
        PyObject *here[2], *block[2];
        Index sizes[2];
        for (int side = 0; side < 2; side++) {
            Index g = from_end ? runs[side] - 1 - passed[side] : passed[side];
            here[side] = item(&call, arrays[side], g);
            sizes[side] = items(&call, here[side]);
            Index k = from_end ? sizes[side] - 1 - blocks[side] : blocks[side];
            block[side] = item(&call, here[side], k);
        }
        if (call.failed || block[0] != block[1])
            break;
        int whole = here[0] == here[1] && blocks[0] == blocks[1] && !blocks[0];
        if (whole) {
            Index g = from_end ? runs[0] - 1 - passed[0] : passed[0];
            rows += end_of_run(&call, values[1], g) - end_of_run(&call, values[1], g - 1);
        } else
            rows += rows_in(&call, block[0]);
        for (int side = 0; side < 2; side++)
            if (whole || ++blocks[side] == sizes[side]) {
                passed[side]++;
                blocks[side] = 0;
            }
    }
    return finish(&call, call.failed ? NULL : PyLong_FromSsize_t(rows));
}
