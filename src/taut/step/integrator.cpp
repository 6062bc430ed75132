#include "taut/step/integrator.h"

#include "taut/step/bdf2.h"
#include "taut/step/euler.h"

namespace taut {

const char* name_of(IntegratorKind kind) {
  switch (kind) {
    case IntegratorKind::semi_implicit_euler: return "semi_implicit_euler";
    case IntegratorKind::imex: return "imex";
    case IntegratorKind::bdf2: return "bdf2";
  }
  return "unknown";
}

std::unique_ptr<Integrator> make_integrator(IntegratorKind kind) {
  switch (kind) {
    case IntegratorKind::semi_implicit_euler: return std::make_unique<SemiImplicitEuler>();
    case IntegratorKind::imex: return std::make_unique<Imex>();
    case IntegratorKind::bdf2: return std::make_unique<Bdf2>();
  }
  return nullptr;
}

}  // namespace taut
