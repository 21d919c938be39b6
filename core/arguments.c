/* Arrays in and out through the buffer protocol, and memory that lives for one call. */
#include "core.h"

#include <stdlib.h>
#include <string.h>

void begin(Call *call, Index count, Index expected)
{
    call->opened = call->held = call->failed = 0;
    if (count != expected) {
        PyErr_Format(PyExc_TypeError, "expected %zd arguments, got %zd", expected, count);
        call->failed = 1;
    }
}

void drop(Call *call, int held, void *const *wanted, int count)
{
    int kept = held;
    for (int i = held; i < call->held; i++) {
        int stays = 0;
        for (int k = 0; k < count; k++)
            stays |= call->blocks[i] == wanted[k];
        if (stays)
            call->blocks[kept++] = call->blocks[i];
        else
            free(call->blocks[i]);
    }
    call->held = kept;
}

PyObject *finish(Call *call, PyObject *result)
{
    while (call->opened)
        PyBuffer_Release(&call->views[--call->opened]);
    drop(call, 0, NULL, 0);
    if (call->failed) {
        Py_XDECREF(result);
        return NULL;
    }
    return result;
}

void expect(Call *call, int condition, const char *otherwise)
{
    if (!call->failed && !condition) {
        PyErr_SetString(PyExc_ValueError, otherwise);
        call->failed = 1;
    }
}

static void *block(Call *call, size_t size)
{
    if (call->failed)
        return NULL;
    void *memory = call->held < MOST_BLOCKS ? malloc(size ? size : 1) : NULL;
    if (!memory) {
        PyErr_NoMemory();
        call->failed = 1;
        return NULL;
    }
    return call->blocks[call->held++] = memory;
}

double *scratch(Call *call, Index count) { return block(call, (size_t)count * sizeof(double)); }

Index *index_scratch(Call *call, Index count) { return block(call, (size_t)count * sizeof(Index)); }

/* Open a view; what does not lie row after row, or at odd addresses (numpy says "=d"), is copied. */
static void *opened(Call *call, PyObject *array, int flags, const char *formats, Py_buffer **view)
{
    if (call->failed)
        return NULL;
    if (call->opened == MOST_VIEWS) {
        expect(call, 0, "too many arrays");
        return NULL;
    }
    Py_buffer *found = *view = &call->views[call->opened];
    if (PyObject_GetBuffer(array, found, flags) < 0) {
        call->failed = 1;
        return NULL;
    }
    call->opened++;
    int odd = found->format && found->format[0] == '=' && !(flags & PyBUF_WRITABLE);
    const char *format = found->format ? found->format + odd : "";
    if (found->itemsize != 8 || !format[0] || !strchr(formats, format[0])) {
        PyErr_Format(PyExc_TypeError, "expected an array of format %s, got %s", formats,
                     found->format ? found->format : "bytes");
        call->failed = 1;
        return NULL;
    }
    if (!odd && PyBuffer_IsContiguous(found, 'C'))
        return found->buf;
    void *copy = block(call, (size_t)found->len);
    if (copy && PyBuffer_ToContiguous(copy, found, found->len, 'C') < 0) {
        call->failed = 1;
        return NULL;
    }
    return copy;
}

static Table table(Call *call, PyObject *array, int flags)
{
    Table none = {NULL, 0, 0};
    Py_buffer *view;
    double *at = opened(call, array, flags, "d", &view);
    if (!at)
        return none;
    Table found = {at, view->ndim ? view->shape[0] : 1, 1};
    for (int axis = 1; axis < view->ndim; axis++)
        found.columns *= view->shape[axis];
    /* Rows that are counted can be read: their first column at least. */
    expect(call, !found.rows || found.columns, "an array has rows without columns");
    return call->failed ? none : found;
}

Table reals(Call *call, PyObject *array) { return table(call, array, PyBUF_FULL_RO); }

Table reals_or_none(Call *call, PyObject *array)
{
    Table none = {NULL, 0, 0};
    return array == Py_None ? none : table(call, array, PyBUF_FULL_RO);
}

Table output(Call *call, PyObject *array)
{
    return table(call, array, PyBUF_C_CONTIGUOUS | PyBUF_WRITABLE | PyBUF_FORMAT);
}

Places places(Call *call, PyObject *array)
{
    Py_buffer *view;
    const Index *at = opened(call, array, PyBUF_FULL_RO, "lqn", &view);
    Places found = {at, at ? view->len / (Index)sizeof(Index) : 0};
    return found;
}

Slots slots(Call *call, PyObject *array)
{
    Py_buffer *view;
    Index *at = opened(call, array, PyBUF_C_CONTIGUOUS | PyBUF_WRITABLE | PyBUF_FORMAT, "lqn", &view);
    Slots found = {at, at ? view->len / (Index)sizeof(Index) : 0};
    return found;
}

Index integer(Call *call, PyObject *number)
{
    if (call->failed)
        return 0;
    Index value = PyNumber_AsSsize_t(number, PyExc_OverflowError); /* of numpy's integers, too */
    call->failed = value == -1 && PyErr_Occurred();
    return value;
}

double real(Call *call, PyObject *number)
{
    if (call->failed)
        return 0.0;
    double value = PyFloat_AsDouble(number);
    call->failed = value == -1.0 && PyErr_Occurred();
    return value;
}

PyObject *bytes_of(const void *numbers, Index size)
{
    return PyByteArray_FromStringAndSize(numbers, size);
}

PyObject *pair_of(Call *call, PyObject *first, PyObject *second)
{
    PyObject *pair = first && second ? PyTuple_Pack(2, first, second) : NULL;
    Py_XDECREF(first);
    Py_XDECREF(second);
    call->failed |= !pair;
    return pair;
}

PyObject *numbers(Call *call, const double *at, Index count)
{
    PyObject *list = call->failed ? NULL : PyList_New(0);
    call->failed |= !list;
    for (Index i = 0; !call->failed && i < count; i++) {
        PyObject *number = PyFloat_FromDouble(at[i]);
        call->failed |= !number || PyList_Append(list, number) < 0;
        Py_XDECREF(number);
    }
    return list;
}
