// SIMVIS_PROGRAM_API marks what simvis-run uses of the library's private modules.
//
// simvis-run links the shared library as its plug-ins do, so that one registry of types and one pool of threads are in
// the process. What it needs beyond the public headers is exported with this mark. No installed header declares these
// names, and any version may change them. tests/public/exported_names_test.cpp lists them.
#pragma once

#include <simvis/export.h>

#define SIMVIS_PROGRAM_API SIMVIS_API
