#include <gtest/gtest.h>

#include "solve/constrained_case.h"
#include "taut_cholmod/cholmod.h"

// Registered before the tests are listed: those with one case a backend see it.
int main(int argc, char** argv) {
  taut::register_cholmod();
  taut::test::backend_under_test = "cholmod";
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
