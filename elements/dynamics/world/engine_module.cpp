#include "elements/dynamics/world/engine_module.h"

#include <dlfcn.h>

#include <atomic>
#include <filesystem>
#include <string>

#include <simvis/error.h>
#include "engine/base/beside_library.h"

namespace simvis {
namespace {

std::atomic<bool> loaded{false};

const DynamicsEngine& load() {
  const std::filesystem::path file = beside_library("simvis-dynamics.so");
  void* const module = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (module == nullptr) throw MachineError("the engine of rigid bodies cannot be loaded: " + std::string(::dlerror()));
  void* const function = ::dlsym(module, kDynamicsEngineSymbol);
  if (function == nullptr) throw MachineError(file.string() + " is no engine of rigid bodies of this SimVis");
  loaded = true;
  return *reinterpret_cast<const DynamicsEngine* (*)()>(function)();
}

}  // namespace

const DynamicsEngine& dynamics_engine() {
  static const DynamicsEngine& engine = load();
  return engine;
}

bool dynamics_engine_is_loaded() { return loaded; }

}  // namespace simvis
