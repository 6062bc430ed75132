// Odd and broken Matrix Market files that other projects collected: each is read rightly or refused
// with its place, in 2 s and 1 GB.
#include <numeric>

#include "io/malformed_table.h"
#include "taut/io/matrix_market.h"

namespace taut::test {
namespace {

// Size, number of entries (both triangles) and their sum, which tells values that were read
// wrongly.
std::string mtx_summary(const std::filesystem::path& path) {
  const MatrixMarket matrix = read_matrix_market(path);
  double sum = 0;
  for (const MatrixEntry& entry : matrix.entries) sum += entry.value;
  for (const double value : matrix.values) sum += value;
  char text[32];
  std::snprintf(text, sizeof text, "%.12g", sum);
  return std::to_string(matrix.rows) + "x" + std::to_string(matrix.columns) + " " +
         std::to_string(matrix.dense ? matrix.values.size() : matrix.entries.size()) +
         " entries sum " + text;
}

TEST(MalformedMatrixMarket, EachFileIsReadRightlyOrRefusedWithItsPlace) {
  check_table(
      {
          {"fmm-invalid_bad_banner.mtx", ":1:1",
           "begins with '%%__badbanner', a Matrix Market file begins with %%MatrixMarket"},
          {"fmm-invalid_bad_field.mtx", ":1:34",
           "the field is '____', real, integer or pattern was expected"},
          {"fmm-invalid_bad_object.mtx", ":1:16", "the object is '___', matrix was expected"},
          {"fmm-invalid_bad_value.mtx", ":3:5",
           "the value is 'not_a_double', a number was expected"},
          {"fmm-invalid_bad_value_3.mtx", ":4:3",
           "the value is 'ffsafdsafas', a number was expected"},
          {"fmm-invalid_dimensions_out_of_range_1.mtx", ":3:1",
           "the number of rows is -3, which is negative"},
          {"fmm-invalid_dimensions_out_of_range_3.mtx", ":3:5",
           "the number of entries is -3, which is negative"},
          {"fmm-invalid_indices_out_of_range_2.mtx", ":6:3",
           "the column index is 2000, 1 to 7 was expected"},
          {"fmm-invalid_indices_out_of_range_4.mtx", ":6:3",
           "the column index is 0, 1 to 7 was expected"},
          {"fmm-invalid_indices_out_of_range_6.mtx", ":6:3",
           "the column index is -2, 1 to 7 was expected"},
          {"fmm-invalid_symmetry_vector.mtx", ":1:39", "a vector cannot be symmetric"},
          {"fmm-invalid_truncated_header_2.mtx", ":1:33", "the header ends before its symmetry"},
          {"fmm-invalid_truncated_line_2.mtx", ":5:2", "the column index is missing"},
          {"fmm-invalid_vector_array_too_long.mtx", ":7:1",
           "more than the 4 entries announced in line 2"},
          {"fmm-invalid_vector_index_out_of_range_1.mtx", ":4:1",
           "the row index is 0, 1 to 4 was expected"},
          {"fmm-invalid_vector_negative_length.mtx", ":2:1",
           "the number of rows is -4, which is negative"},
          {"fmm-overflow_index_gt_int64.mtx", ":6:1",
           "the row index is '19223372036854775808', which is too large"},
          {"fmm-overflow_value_gt_complex128.mtx", ":1:34",
           "the matrix is complex, a real one was expected"},
          // An infinite entry makes no matrix that anyone can solve.
          {"fmm-overflow_value_gt_float64.mtx", ":4:5",
           "the value is '1E310', a finite number was expected"},
          // Beyond 64 bits but well within double.
          {"fmm-overflow_value_gt_int64.mtx", "", "3x3 3 entries sum 1.9223372039e+19"},
          {"fmm-permissive_banner_one_percent_eye3.mtx", "", "3x3 3 entries sum 3"},
          {"fmm-windows_lineendings_nist_ex1_more_freeformat.mtx", "", "5x5 8 entries sum 33.335"},
          {"lagraph-mangled10.mtx", ":7:1",
           "the file ends after 2 entries, 3 were announced in line 4"},
          {"lagraph-mangled12.mtx", ":5:4", "the value is missing"},
          // The same entry twice: added up.
          {"lagraph-mangled14.mtx", "", "3x4 2 entries sum 13.5"},
          {"lagraph-mangled16.mtx", ":5:6", "found '.959', the end of the line was expected"},
          {"lagraph-mangled3.mtx", ":1:34", "the field is 'mangled'"},
          {"lagraph-mangled5.mtx", ":1:42", "the matrix is Hermitian"},
          {"lagraph-mangled7.mtx", ":5:4", "the value is missing"},
          {"lagraph-mangled9.mtx", ":4:3", "has 3 rows and 4 columns, but was declared symmetric"},
          {"lagraph-mangled_format.mtx", ":1:29", "an array cannot be of field pattern"},
          // These three break only the type that another library's comment promises.
          {"lagraph-mangled_int32.mtx", "", "7x7 12 entries sum 42"},
          {"lagraph-mangled_skew.mtx", "", "6x6 20 entries sum 0"},
          {"lagraph-mangled_uint32.mtx", "", "7x7 12 entries sum 4294967340"},
      },
      ".mtx", mtx_summary);
}

}  // namespace
}  // namespace taut::test
