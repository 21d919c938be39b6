/* The module multirep.splines._core; _core.pyi says what each function takes. */
#include "core.h"

#define ENTRY(name) {#name, (PyCFunction)(void (*)(void))core_##name, METH_FASTCALL, NULL}

static PyMethodDef methods[] = {
    ENTRY(find_spans),
    ENTRY(basis_functions),
    ENTRY(blossom),
    ENTRY(rope),
    ENTRY(points),
    ENTRY(capsule),
    ENTRY(merged_capsules),
    ENTRY(leaf),
    ENTRY(nearest),
    ENTRY(polyline_rows),
    ENTRY(solve_window),
    ENTRY(breakpoints),
    ENTRY(fit),
    ENTRY(chord_bounds),
    ENTRY(sample),
    ENTRY(attempt),
    ENTRY(spare),
    ENTRY(follow),
    ENTRY(predict),
    ENTRY(beginning),
    ENTRY(halves),
    ENTRY(largest),
    ENTRY(course),
    ENTRY(target),
    ENTRY(between_common),
    ENTRY(interpolate),
    ENTRY(stretch),
    ENTRY(join),
    ENTRY(simplify),
    ENTRY(common),
    ENTRY(changed_spans),
    ENTRY(recount),
    ENTRY(refine_uniform),
    ENTRY(add_details),
    ENTRY(analyse),
    ENTRY(plus),
    ENTRY(thin),
    ENTRY(insert_knots),
    ENTRY(insert_knot),
    ENTRY(place),
    ENTRY(searched),
    ENTRY(with_block),
    ENTRY(joined),
    ENTRY(shared_rows),
    {NULL, NULL, 0, NULL},
};

/* A checksum of the _core.pyi that this was built with; setup.py gives it. */
static int stamp(PyObject *module)
{
    return PyModule_AddIntConstant(module, "INTERFACE", CORE_INTERFACE);
}

static PyModuleDef_Slot module_slots[] = {{Py_mod_exec, (void *)stamp}, {0, NULL}};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, .m_name = "_core", .m_doc = "Splines, compiled.", .m_size = 0,
    .m_methods = methods, .m_slots = module_slots,
};

PyMODINIT_FUNC PyInit__core(void) { return PyModuleDef_Init(&definition); }
