#include "taut/io/matrix_market.h"

#include <gtest/gtest.h>

#include <cmath>

#include "io/limits.h"
#include "io/temporary_folder.h"
#include "taut/base/error.h"
#include "test_data.h"

namespace taut::test {
namespace {

using Entries = std::vector<MatrixEntry>;

MatrixMarket parse(std::string_view text) {
  const TemporaryFolder folder;
  return read_matrix_market(folder.file("a.mtx", text));
}

std::string refusal(std::string_view text) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.file("a.mtx", text);
  try {
    read_matrix_market(path);
  } catch (const InputError& error) {
    return std::string(error.what()).substr(path.string().size());
  }
  return "read";
}

std::string system_refusal(const MatrixMarket& matrix) {
  try {
    to_system_matrix(matrix, "A.mtx");
  } catch (const InputError& error) {
    return error.what();
  }
  return "taken";
}

const std::string general = "%%MatrixMarket matrix coordinate real general\n";
const std::string symmetric = "%%MatrixMarket matrix coordinate real symmetric\n";

TEST(ReadMatrixMarket, CoordinateGeneral) {
  const MatrixMarket matrix = parse(general + "% c\n\n2 3 3\n2 1 -4e-1\n% c\n1 3 +2\n\n1 1 7");
  EXPECT_EQ(matrix.rows, 2);
  EXPECT_EQ(matrix.columns, 3);
  EXPECT_FALSE(matrix.dense);
  EXPECT_EQ(matrix.declared, MatrixSymmetry::general);
  EXPECT_EQ(matrix.entries, (Entries{{0, 0, 7}, {0, 2, 2}, {1, 0, -0.4}}));
}

TEST(ReadMatrixMarket, SymmetricFromEitherTriangleButNotBoth) {
  const Entries both = {{0, 0, 2}, {0, 1, -1}, {1, 0, -1}, {1, 1, 3}};
  EXPECT_EQ(parse(symmetric + "2 2 3\n1 1 2\n2 1 -1\n2 2 3\n").entries, both);
  EXPECT_EQ(parse(symmetric + "2 2 3\n1 1 2\n1 2 -1\n2 2 3\n").entries, both);
  EXPECT_EQ(refusal(symmetric + "2 2 4\n1 1 2\n2 1 -1\n1 2 -1\n2 2 3\n")
                .rfind(":5:3: the entry (1, 2) lies in the other triangle", 0),
            0u);
}

TEST(ReadMatrixMarket, SkewPatternIntegerAndVector) {
  EXPECT_EQ(parse("%%MatrixMarket matrix coordinate real skew-symmetric\n2 2 1\n2 1 5\n").entries,
            (Entries{{0, 1, -5}, {1, 0, 5}}));
  EXPECT_EQ(parse("%%MatrixMarket MATRIX Coordinate Pattern Symmetric\n2 2 1\n2 1\n").entries,
            (Entries{{0, 1, 1}, {1, 0, 1}}));
  EXPECT_EQ(parse("%%MatrixMarket matrix coordinate integer general\n2 2 1\n2 1 -9\n").entries,
            (Entries{{1, 0, -9}}));
  EXPECT_EQ(parse("%%MatrixMarket vector coordinate real general\n4 1\n3 2.5\n").entries,
            (Entries{{2, 0, 2.5}}));
  EXPECT_EQ(parse("%%MatrixMarket vector array real general\n2\n3\n4\n").values,
            (std::vector<double>{3, 4}));
}

TEST(ReadMatrixMarket, ArraysGoColumnByColumn) {
  EXPECT_EQ(parse("%%MatrixMarket matrix array real general\n2 3\n1\n2\n3\n4\n5\n6\n").values,
            (std::vector<double>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(parse("%%MatrixMarket matrix array real symmetric\n3 3\n1\n2\n3\n4\n5\n6\n").values,
            (std::vector<double>{1, 2, 3, 2, 4, 5, 3, 5, 6}));
  EXPECT_EQ(parse("%%MatrixMarket matrix array real skew-symmetric\n3 3\n1\n2\n3\n").values,
            (std::vector<double>{0, 1, 2, -1, 0, 3, -2, -3, 0}));
}

TEST(ReadMatrixMarket, DuplicatesAreAddedOnBothSides) {
  EXPECT_EQ(parse(symmetric + "2 2 3\n2 1 1\n2 1 0.5\n1 1 4\n").entries,
            (Entries{{0, 0, 4}, {0, 1, 1.5}, {1, 0, 1.5}}));
}

TEST(ReadMatrixMarket, RefusalsNameLineAndColumn) {
  EXPECT_EQ(refusal("").rfind(":1:1: the file begins with ''", 0), 0u);
  EXPECT_EQ(refusal(general).rfind(":2:1: the file ends before the line with the matrix's size", 0),
            0u);
  EXPECT_EQ(refusal(general + "2 2\n").rfind(":2:4: the number of entries is missing", 0), 0u);
  EXPECT_EQ(refusal(general + "2 2 1 1\n").rfind(":2:7: found '1'", 0), 0u);
  EXPECT_EQ(refusal(general + "9999999999 2 1\n")
                .rfind(":2:1: the number of rows is 9999999999, at most 2147483647", 0),
            0u);
  EXPECT_EQ(refusal(general + "2 2 1\n1 1 nan\n")
                .rfind(":3:5: the value is 'nan', a finite number was expected", 0),
            0u);
  EXPECT_EQ(refusal(general + "2 2 1\n1 1 1,5\n")
                .rfind(":3:5: the value is '1,5', a number was expected", 0),
            0u);
  EXPECT_EQ(refusal("%%MatrixMarket matrix coordinate integer general\n1 1 1\n1 1 1.5\n")
                .rfind(":3:5: the value is '1.5', a whole", 0),
            0u);
  EXPECT_EQ(refusal("%%MatrixMarket matrix coordinate real skew-symmetric\n2 2 1\n1 1 5\n")
                .rfind(":3:5: the diagonal of a skew", 0),
            0u);
}

TEST(ReadMatrixMarket, HeaderThatAnnouncesTooMuchTakesNoMemory) {
  const TemporaryFolder folder;
  for (const std::string& text :
       {general + "2000000000 2000000000 1000000000000000000\n1 1 1\n",
        std::string("%%MatrixMarket matrix array real ") + "general\n2000000000 2000000000\n1\n",
        std::string("%%MatrixMarket matrix array real symmetric\n2000000000 2000000000\n1\n")}) {
    const std::filesystem::path path = folder.file("a.mtx", text);
    const std::string found = run_limited([&]() -> std::string {
      try {
        read_matrix_market(path);
      } catch (const InputError& error) {
        return error.what();
      }
      return "read";
    });
    EXPECT_NE(found.find(":4:1: the file ends after 1 entries"), std::string::npos) << found;
  }
  const std::filesystem::path path = folder.file("a.mtx", general + "2000000000 2000000000 0\n");
  EXPECT_NE(run_limited([&] {
              return system_refusal(read_matrix_market(path));
            }).find("(1, 1) is zero or missing"),
            std::string::npos);
}

TEST(ReadMatrixMarket, CutAnywhereItIsReadOrRefused) {
  const std::string text =
      "%%MatrixMarket matrix coordinate real symmetric\r\n% c\r\n3 3 4\r\n1 1 1.5e0\r\n2 2 2\r\n3 "
      "3 3\r\n3 1 -0.25";
  int read = 0;
  for (std::size_t length = 0; length <= text.size(); ++length) {
    const std::string found = refusal(std::string_view(text).substr(0, length));
    read += found == "read";
    EXPECT_TRUE(found == "read" || found[0] == ':') << found;
  }
  // The last number may lose digits unseen: -0, -0., -0.2, -0.25.
  EXPECT_EQ(read, 4);
}

TEST(ReadVector, ArrayOrSparseOfTheRightLength) {
  const TemporaryFolder folder;
  const std::string sparse = "%%MatrixMarket matrix coordinate real general\n3 1 1\n2 1 5\n";
  EXPECT_EQ(read_vector(folder.file("b.mtx", sparse), 3), (std::vector<double>{0, 5, 0}));
  EXPECT_EQ(
      read_vector(folder.file("b.mtx", "%%MatrixMarket matrix array real general\n2 1\n5\n6\n"), 2),
      (std::vector<double>{5, 6}));
  EXPECT_THROW(read_vector(folder.file("b.mtx", sparse), 4), InputError);
  EXPECT_THROW(
      read_vector(folder.file("b.mtx", "%%MatrixMarket matrix array real general\n1 2\n5\n6\n"), 1),
      InputError);
}

TEST(ToSystemMatrix, HoldsTheMatrix) {
  const BlockCsr a =
      to_system_matrix(parse(symmetric + "3 3 4\n1 1 4\n2 2 5\n3 3 6\n3 1 -1\n"), "A.mtx");
  EXPECT_EQ(a.rows(), 3);
  EXPECT_EQ(a.pattern->uniform_dim, 1);
  EXPECT_EQ(a.pattern->blocks(), 5);
  const double expected[3][3] = {{4, 0, -1}, {0, 5, 0}, {-1, 0, 6}};
  for (Index i = 0; i < 3; ++i)
    for (Index j = 0; j < 3; ++j) EXPECT_EQ(a.at(i, j), expected[i][j]) << i << ' ' << j;
  const BlockCsr dense = to_system_matrix(
      parse("%%MatrixMarket matrix array real general\n2 2\n4\n1\n1\n5\n"), "A.mtx");
  EXPECT_EQ(dense.at(0, 1), 1);
  EXPECT_EQ(dense.at(1, 1), 5);
}

TEST(ToSystemMatrix, RoundingIsSymmetrisedRealAsymmetryRefused) {
  const BlockCsr a = to_system_matrix(
      parse(general + "2 2 4\n1 1 1\n2 2 1\n2 1 0.5\n1 2 0.50000000000001\n"), "A.mtx");
  EXPECT_EQ(a.at(0, 1), a.at(1, 0));
  EXPECT_NEAR(a.at(0, 1), 0.500000000000005, 1e-15);
  // An entry that rounding made non-zero has no partner in the file, but gets one in the matrix.
  const BlockCsr b = to_system_matrix(parse(general + "2 2 3\n1 1 1\n2 2 1\n1 2 1e-17\n"), "A.mtx");
  EXPECT_EQ(b.pattern->blocks(), 4);
  EXPECT_EQ(b.at(1, 0), 0.5e-17);
  EXPECT_EQ(system_refusal(parse(general + "3 3 5\n1 1 1\n2 2 1\n3 3 1\n3 2 0.5\n2 3 0.25\n")),
            "A.mtx: is not symmetric: entry (2, 3) is 0.25, but entry (3, 2) is 0.5; a symmetric "
            "positive definite matrix was expected");
  EXPECT_EQ(system_refusal(parse(general + "2 2 3\n1 1 1\n2 2 1\n2 1 0.5\n"))
                .rfind("A.mtx: is not symmetric: entry (1, 2) is 0,", 0),
            0u);
}

TEST(ToSystemMatrix, RefusesWhatCannotBeASystem) {
  EXPECT_EQ(system_refusal(parse(general + "2 3 1\n1 1 1\n"))
                .rfind("A.mtx: has 2 rows and 3 columns, a square matrix was expected", 0),
            0u);
  EXPECT_EQ(system_refusal(parse(general + "3 3 2\n1 1 1\n3 3 1\n"))
                .rfind("A.mtx: the diagonal entry (2, 2) is zero or missing", 0),
            0u);
  EXPECT_EQ(system_refusal(parse(general + "2 2 2\n1 1 1\n2 2 0\n"))
                .rfind("A.mtx: the diagonal entry (2, 2) is zero or missing", 0),
            0u);
  EXPECT_EQ(
      system_refusal(parse("%%MatrixMarket matrix coordinate real skew-symmetric\n2 2 1\n2 1 5\n"))
          .rfind("A.mtx: is skew-symmetric", 0),
      0u);
  EXPECT_EQ(system_refusal(parse(general + "1 1 2\n1 1 1.7e308\n1 1 1.7e308\n")),
            "A.mtx: entry (1, 1) is not finite");
}

TEST(WriteMatrixMarket, BlockMatrixReadsBackToTheSameBits) {
  const std::vector<Index> dims = {3, 1, 0, 2};
  BlockCsr a(make_pattern({{0, 1, 3}, {0, 1}, {2}, {0, 3}}, dims));
  for (Index i = 0; i < 6; ++i)
    for (Index j = 0; j <= i; ++j)
      for (const auto& [row, column] : {std::pair(i, j), std::pair(j, i)}) {
        // Node of each unknown: 0 0 0 1 3 3.
        const Index node_row = row < 3    ? 0
                               : row == 3 ? 1
                                          : 3,
                    node_column = column < 3    ? 0
                                  : column == 3 ? 1
                                                : 3;
        const Index k = a.pattern->find(node_row, node_column);
        if (k < 0) continue;
        const Index r = row - a.pattern->dof_start[node_row],
                    c = column - a.pattern->dof_start[node_column];
        a.block(node_row, k)[r * a.pattern->width(node_row) + c] = 1.0 / (3 + i) + 1e-9 * j / 7;
      }
  const TemporaryFolder folder;
  write_symmetric_matrix(folder / "a.mtx", a, "first line\nsecond line");
  const MatrixMarket back = read_matrix_market(folder / "a.mtx");
  EXPECT_EQ(back.rows, 6);
  EXPECT_EQ(back.declared, MatrixSymmetry::symmetric);
  EXPECT_EQ(back.entries.size(), 9u + 3 + 3 + 6 + 6 + 1 + 4);
  for (const MatrixEntry& entry : back.entries)
    EXPECT_EQ(entry.value, a.at(entry.row, entry.column)) << entry.row << ' ' << entry.column;
  EXPECT_NE(read_file(folder / "a.mtx").find("% first line\n% second line\n6 6 19\n"),
            std::string::npos);
}

TEST(WriteMatrixMarket, EntriesAndVectorsReadBackToTheSameBits) {
  const TemporaryFolder folder;
  const Entries entries = {{0, 1, 1.0 / 3}, {1, 0, -5e-324}, {1, 2, 1.7976931348623157e308}};
  write_general_matrix(folder / "g.mtx", 2, 3, entries);
  EXPECT_EQ(read_matrix_market(folder / "g.mtx").entries, entries);
  EXPECT_EQ(read_matrix_market(folder / "g.mtx").columns, 3);
  const Entries lower = {{0, 0, 0.1}, {1, 0, 0.2}};
  write_symmetric_matrix(folder / "s.mtx", 2, lower);
  EXPECT_EQ(read_matrix_market(folder / "s.mtx").entries,
            (Entries{{0, 0, 0.1}, {0, 1, 0.2}, {1, 0, 0.2}}));
  std::vector<double> vector;
  for (int i = 0; i < 200; ++i) vector.push_back(std::ldexp(std::sin(i), i * 5 - 500));
  write_vector(folder / "v.mtx", vector, "m/s");
  EXPECT_EQ(read_vector(folder / "v.mtx", 200), vector);
}

struct KnownMatrix {
  const char* file;
  Index rows;
  std::size_t entries;  // both triangles
  const char* as_system;
};

TEST(ReadMatrixMarket, MatricesOfOtherProjects) {
  const auto data = data_folder();
  if (!data) GTEST_SKIP() << "no ../shared/data and no $TAUT_DATA";
  for (const KnownMatrix& known :
       {KnownMatrix{"1138_bus.mtx", 1138, 4054, "taken"}, KnownMatrix{"LFAT5.mtx", 14, 46, "taken"},
        KnownMatrix{"ani1.mtx", 36, 208, "taken"}, KnownMatrix{"isai_spd.mtx", 100, 914, "taken"},
        KnownMatrix{"bcsstk13.mtx.gz", 2003, 83883, "taken"},
        KnownMatrix{"zenios.mtx", 2873, 27191,
                    "A.mtx: the diagonal entry (1, 1) is zero or missing"}}) {
    const MatrixMarket matrix = read_matrix_market(*data / "matrices" / known.file);
    EXPECT_EQ(matrix.rows, known.rows) << known.file;
    EXPECT_EQ(matrix.columns, known.rows) << known.file;
    EXPECT_EQ(matrix.entries.size(), known.entries) << known.file;
    EXPECT_EQ(system_refusal(matrix).rfind(known.as_system, 0), 0u)
        << known.file << ": " << system_refusal(matrix);
  }
  const BlockCsr bus =
      to_system_matrix(read_matrix_market(*data / "matrices/1138_bus.mtx"), "1138_bus");
  EXPECT_EQ(bus.at(0, 4), -9.017133);
  EXPECT_EQ(bus.at(4, 0), -9.017133);
  EXPECT_EQ(bus.at(1137, 1137), 117.647);
}

}  // namespace
}  // namespace taut::test
