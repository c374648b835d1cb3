// Threads inside functions of the module, work without the interpreter's lock, and the end of the interpreter.
//
// CPython ends a thread that asks for the lock while the interpreter ends. Within a C++ function that aborts the
// process. So the end of the interpreter waits until no thread is inside the module (simvis/_ending.py), and then only
// the thread that ends it may enter.
#pragma once

#include <nanobind/nanobind.h>

#include <optional>
#include <utility>

namespace simvis::python {

/// While it lives, the calling thread counts as inside. Made and destroyed with the interpreter's lock.
class InsideModule {
 public:
  InsideModule();
  ~InsideModule();
  InsideModule(const InsideModule&) = delete;
  InsideModule& operator=(const InsideModule&) = delete;

  /// Whether the calling thread may enter.
  static bool may_enter();
};

/// One call from Python. Raises SystemExit, which ends a thread silently, in a thread that may not enter.
class ModuleCall {
 public:
  ModuleCall();

 private:
  InsideModule inside_;
};

/// While it lives, the calling thread works without the interpreter's lock.
class FreeWork {
 private:
  ModuleCall call_;
  nanobind::gil_scoped_release free_;  // ends first
};

/// As nanobind::class_, with a ModuleCall around each function and computed property.
template <typename T>
class BoundClass : public nanobind::class_<T> {
 public:
  using nanobind::class_<T>::class_;

  template <typename... Arguments>
  BoundClass& def(Arguments&&... arguments) {
    nanobind::class_<T>::def(std::forward<Arguments>(arguments)..., nanobind::call_guard<ModuleCall>());
    return *this;
  }
  template <typename... Arguments>
  BoundClass& def_static(Arguments&&... arguments) {
    nanobind::class_<T>::def_static(std::forward<Arguments>(arguments)..., nanobind::call_guard<ModuleCall>());
    return *this;
  }
  template <typename... Arguments>
  BoundClass& def_prop_ro(Arguments&&... arguments) {
    nanobind::class_<T>::def_prop_ro(std::forward<Arguments>(arguments)..., nanobind::call_guard<ModuleCall>());
    return *this;
  }
};

void bind_free_work(nanobind::module_& module);

}  // namespace simvis::python
