#include <gtest/gtest.h>

#include "solve/constrained_case.h"
#include "taut_pardiso/pardiso.h"

// Registered before the tests are listed: those with one case a backend or solver see it. CHOLMOD,
// tested elsewhere, is linked but not registered.
int main(int argc, char** argv) {
  taut::register_pardiso();
  taut::test::backend_under_test = "pardiso";
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
