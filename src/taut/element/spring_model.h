#pragma once
// All springs of one class (stretch, shear or bend) of one cloth, as a ForceModel. Formulas:
// spring_law.h. Each spring adds [B -B; -B B] to the matrix and g, -g to the vector, B and g as
// ForceModel's combination.

#include "taut/element/force_model.h"
#include "taut/element/spring_law.h"

namespace taut {

struct Spring {
  Index i = 0, j = 0;
  SpringParameters parameters;
};

class SpringModel : public ForceModel {
 public:
  SpringModel(ForceClass force_class, SpringLawKind law, std::vector<Spring> springs);

  ForceClass force_class() const override { return class_; }
  bool stable_explicitly() const override { return stable_explicitly_; }
  void mark_stable_explicitly() { stable_explicitly_ = true; }
  Index nodes_per_element() const override { return 2; }
  Index blocks_per_element() const override { return 1; }
  Index block_count() const override { return static_cast<Index>(springs_.size()); }
  Index vector_count() const override { return block_count(); }
  void connect(ConnectionSink& sink) const override;
  void evaluate(const ForceRequest& request, std::span<double> blocks,
                std::span<Vec3> vectors) const override;
  void bound_blocks(double matrix_stiffness, double matrix_damping,
                    std::span<double> bounds) const override;
  double energy(std::span<const Vec3> x) const override;
  Index collapsed(std::span<const Vec3> x) const override;

  SpringLawKind law() const { return law_; }
  std::span<const Spring> springs() const { return springs_; }

 private:
  ForceClass class_;
  SpringLawKind law_;
  bool stable_explicitly_ = false;
  std::vector<Spring> springs_;
};

// L/L0 - 1 of every spring: 0 at rest, negative when compressed.
std::vector<double> spring_strains(const SpringModel& model, std::span<const Vec3> x);
// The largest of them.
double largest_strain(const SpringModel& model, std::span<const Vec3> x);

}  // namespace taut
