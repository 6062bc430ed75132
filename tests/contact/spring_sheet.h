#pragma once
// A small sheet of springs with its own direct solver, for tests of contact on coupled nodes: A = M
// + h² K, b = h (f - h K v), solved in the pre-filtered form (S A S + I - S) y = S (b + friction -
// A z), dv = y + z. Springs: grid edges, diagonals, next-but-one; slack when short.

#include <gtest/gtest.h>

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <utility>

#include "taut/contact/solid_contact.h"

namespace taut::test {

struct SpringSheet {
  struct Spring {
    Index a, b;
    double rest, stiffness;
  };
  using Sparse = Eigen::SparseMatrix<double>;

  Index side;
  double mass = 9.5e-6, drag = 1e-6, t = 0.0;  // kg, kg/s, s
  Vec3 gravity = Vec3(0, 0, -9.81);
  std::vector<Vec3> x, v;
  std::vector<Spring> springs;
  ConstraintSet pins;
  std::vector<int> passes;  // of each step so far

  // side x side nodes at `place(u, w)`, u and w in [0, 1].
  template <class Place>
  SpringSheet(Index nodes_on_side, double stretch, const Place& place) : side(nodes_on_side) {
    for (Index r = 0; r < side; ++r)
      for (Index c = 0; c < side; ++c)
        x.push_back(place(double(c) / (side - 1), double(r) / (side - 1)));
    v.assign(x.size(), Vec3::Zero());
    pins.reset(static_cast<Index>(x.size()));
    for (Index r = 0; r < side; ++r)
      for (Index c = 0; c < side; ++c) {
        join(r, c, 0, 1, stretch), join(r, c, 1, 0, stretch);
        join(r, c, 1, 1, 0.3), join(r, c, 1, -1, 0.3);
        join(r, c, 0, 2, 0.05), join(r, c, 2, 0, 0.05);
      }
  }

  Index node(Index r, Index c) const { return r * side + c; }
  void join(Index r, Index c, Index dr, Index dc, double stiffness) {
    if (r + dr >= side || c + dc >= side || c + dc < 0) return;
    const Index a = node(r, c), b = node(r + dr, c + dc);
    springs.push_back({a, b, (x[b] - x[a]).norm(), stiffness});
  }

  void assemble(double h, Sparse& A, Eigen::VectorXd& b) const {
    const Index n = static_cast<Index>(x.size());
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd force(3 * n), Kv = Eigen::VectorXd::Zero(3 * n);
    const auto add = [&](Index i, Index k, const Mat3& block) {
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) entries.emplace_back(3 * i + r, 3 * k + c, h * h * block(r, c));
    };
    for (Index i = 0; i < n; ++i) {
      force.segment<3>(3 * i) = mass * gravity - drag * v[i];
      for (int r = 0; r < 3; ++r) entries.emplace_back(3 * i + r, 3 * i + r, mass + h * drag);
    }
    for (const Spring& s : springs) {
      const Vec3 d = x[s.b] - x[s.a];
      const double length = d.norm();
      Mat3 K = Mat3::Zero();
      if (length > s.rest) {
        const Vec3 e = d / length;
        K = s.stiffness *
            (e * e.transpose() + (1 - s.rest / length) * (Mat3::Identity() - e * e.transpose()));
        const Vec3 f = s.stiffness * (length - s.rest) * e;
        force.segment<3>(3 * s.a) += f, force.segment<3>(3 * s.b) -= f;
      }
      add(s.a, s.a, K), add(s.b, s.b, K), add(s.a, s.b, -K), add(s.b, s.a, -K);
      const Vec3 kv = K * (v[s.b] - v[s.a]);
      Kv.segment<3>(3 * s.b) += kv, Kv.segment<3>(3 * s.a) -= kv;
    }
    A.resize(3 * n, 3 * n);
    A.setFromTriplets(entries.begin(), entries.end());
    b = h * (force - h * Kv);
  }

  void step(SolidContact& contact, double h) {
    const Index n = static_cast<Index>(x.size());
    Sparse A;
    Eigen::VectorXd b;
    assemble(h, A, b);
    std::vector<Vec3> predicted(x.size()), end(x.size()), j(x.size());
    for (Index i = 0; i < n; ++i) predicted[i] = x[i] + h * v[i];
    Eigen::VectorXd dv;
    contact.begin_step(t, h, x, predicted, pins);
    Eigen::SimplicialLDLT<Sparse> solver;
    bool analyzed = false;
    do {
      ConstraintSet constraints = pins;
      contact.constrain(constraints);
      std::vector<Eigen::Triplet<double>> filter, rest;
      Eigen::VectorXd z(3 * n), rhs = b;
      for (Index i = 0; i < n; ++i) {
        const Mat3 S = constraints.projection(i);
        for (int r = 0; r < 3; ++r)
          for (int c = 0; c < 3; ++c) {
            filter.emplace_back(3 * i + r, 3 * i + c, S(r, c));
            rest.emplace_back(3 * i + r, 3 * i + c, (r == c ? mass : 0.0) - mass * S(r, c));
          }
        z.segment<3>(3 * i) =
            constraints.displacement(i) / h - constraints.constrained_part(i, v[i]);
        if (!contact.impulses().empty()) rhs.segment<3>(3 * i) += contact.impulses()[i];
      }
      Sparse S(3 * n, 3 * n), R(3 * n, 3 * n);
      S.setFromTriplets(filter.begin(), filter.end());
      R.setFromTriplets(rest.begin(), rest.end());
      const Sparse filtered = Sparse(S * A * S) + R;
      if (!std::exchange(analyzed, true)) solver.analyzePattern(filtered);
      solver.factorize(filtered);
      dv = Eigen::VectorXd(solver.solve(S * (rhs - A * z))) + z;
      const Eigen::VectorXd residual = A * dv - b;
      for (Index i = 0; i < n; ++i) {
        j[i] = constraints.constrained_part(i, residual.segment<3>(3 * i));
        end[i] = x[i] + h * (v[i] + dv.segment<3>(3 * i));
      }
    } while (contact.update(end, j));
    passes.push_back(contact.passes());
    contact.finish(end);
    for (Index i = 0; i < n; ++i) v[i] += dv.segment<3>(3 * i);
    x = end;
    t += h;
  }
};

}  // namespace taut::test
