#include "taut/step/integrator.h"

#include "taut/step/bdf2.h"
#include "taut/step/euler.h"

namespace taut {

const char* name_of(IntegratorKind kind) {
  switch (kind) {
    case IntegratorKind::semi_implicit_euler:
      return "semi_implicit_euler";
    case IntegratorKind::imex:
      return "imex";
    case IntegratorKind::imex_adaptive:
      return "imex_adaptive";
    case IntegratorKind::bdf2:
      return "bdf2";
    case IntegratorKind::newton:
      return "newton";
  }
  return "unknown";
}

bool Integrator::relinearise(Assembler&, const ExternalForces&, double, std::span<const Vec3>,
                             std::span<const Vec3>, std::span<const Vec3>, BlockCsr&,
                             std::span<Vec3>) const {
  return false;
}

std::unique_ptr<Integrator> make_integrator(IntegratorKind kind) {
  switch (kind) {
    case IntegratorKind::semi_implicit_euler:
      return std::make_unique<SemiImplicitEuler>();
    case IntegratorKind::imex:
      return std::make_unique<Imex>();
    case IntegratorKind::imex_adaptive:
      return std::make_unique<AdaptiveImex>();
    case IntegratorKind::bdf2:
      return std::make_unique<Bdf2>();
    case IntegratorKind::newton:
      return std::make_unique<ImplicitEuler>();
  }
  return nullptr;
}

}  // namespace taut
