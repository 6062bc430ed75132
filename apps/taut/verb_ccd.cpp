#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "taut/base/error.h"
#include "taut/base/file.h"
#include "taut/base/timer.h"
#include "taut/contact/ccd.h"
#include "taut/io/ccd_queries.h"
#include "verbs.h"

namespace taut::app {

namespace {

struct CcdArguments {
  std::string file, type, json;
  bool wants_json = false;
  CcdOptions options;
};

struct Tally {
  int hits = 0, missed = 0, false_alarms = 0;
  double milliseconds = 0.0;
};

std::vector<Impact> answer(const std::vector<CcdQuery>& queries, bool edges,
                           const CcdOptions& options) {
  std::vector<Impact> impacts;
  for (const auto& [x, y, truth] : queries)
    impacts.push_back(
        edges ? edge_edge_impact(x[0], x[1], x[2], x[3], y[0], y[1], y[2], y[3], options)
              : vertex_triangle_impact(x[0], x[1], x[2], x[3], y[0], y[1], y[2], y[3], options));
  return impacts;
}

Tally tally_of(const std::vector<CcdQuery>& queries, const std::vector<Impact>& impacts,
               double milliseconds) {
  Tally tally{.milliseconds = milliseconds};
  for (std::size_t k = 0; k < queries.size(); ++k) {
    tally.hits += impacts[k].hit;
    tally.missed += queries[k].truth == true && !impacts[k].hit;
    tally.false_alarms += queries[k].truth == false && impacts[k].hit;
  }
  return tally;
}

std::string csv_of(const std::vector<Impact>& impacts) {
  std::string text;
  for (std::size_t k = 0; k < impacts.size(); ++k)
    text +=
        impacts[k].hit ? fmt::format("{},1,{}\n", k, impacts[k].time) : fmt::format("{},0,\n", k);
  return text;
}

nlohmann::ordered_json json_of(const CcdArguments& arguments, const std::vector<CcdQuery>& queries,
                               const std::vector<Impact>& impacts, const Tally& tally) {
  nlohmann::ordered_json report;
  report["file"] = arguments.file;
  report["type"] = arguments.type;
  report["minimum_separation"] = arguments.options.minimum_separation;
  report["tolerance"] = arguments.options.tolerance;
  report["max_checks"] = arguments.options.max_checks;
  report["queries"] = queries.size();
  report["hits"] = tally.hits;
  if (queries[0].truth) {
    report["missed"] = tally.missed;
    report["false_alarms"] = tally.false_alarms;
  }
  report["total_ms"] = tally.milliseconds;
  report["rows"] = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < queries.size(); ++k) {
    nlohmann::ordered_json row{{"index", k}, {"hit", impacts[k].hit}};
    if (impacts[k].hit) row["time"] = impacts[k].time;
    if (queries[k].truth) row["truth"] = *queries[k].truth;
    report["rows"].push_back(row);
  }
  return report;
}

int ccd(const CcdArguments& arguments) {
  const std::vector<CcdQuery> queries = read_ccd_queries(arguments.file);
  const Timer timer;
  const std::vector<Impact> impacts = answer(queries, arguments.type == "ee", arguments.options);
  const Tally tally = tally_of(queries, impacts, timer.milliseconds());
  const std::string json = arguments.wants_json
                               ? json_of(arguments, queries, impacts, tally).dump(2) + "\n"
                               : std::string();
  if (!arguments.json.empty()) write_file(arguments.json, json);
  fmt::print("{}", arguments.wants_json && arguments.json.empty() ? json : csv_of(impacts));
  fmt::print(stderr, "{}: {} queries, {} hits", arguments.file, queries.size(), tally.hits);
  if (queries[0].truth)
    fmt::print(stderr, "; of the true answers, {} collisions missed, {} false alarms", tally.missed,
               tally.false_alarms);
  fmt::print(stderr, "; {:.2f} microseconds a query\n",
             1e3 * tally.milliseconds / static_cast<double>(queries.size()));
  return tally.missed == 0 ? 0 : 1;
}

}  // namespace

void add_ccd_verb(CLI::App& app, int& exit_code) {
  CLI::App* verb = app.add_subcommand("ccd",
                                      "Answer continuous-collision queries of a file: do a vertex "
                                      "and a triangle, or two edges, meet?");
  auto arguments = std::make_shared<CcdArguments>();
  CcdOptions& options = arguments->options;
  verb->add_option(
          "FILE", arguments->file,
          "Eight rows a query: x,y,z as num,den each of four corners at the start, then at the end")
      ->required();
  verb->add_option("--type", arguments->type,
                   "vf: a vertex, then a triangle's three; ee: two edges of two vertices each")
      ->required()
      ->check(CLI::IsMember({"vf", "ee"}));
  verb->add_option("--separation", options.minimum_separation,
                   "m: nearer than this is a collision (default: 0, touching)")
      ->check(between(0.0, 1e100));
  verb->add_option("--tolerance", options.tolerance,
                   "m: a near miss closer than this may be called a collision (default: 1e-10)")
      ->check(between(0.0, 1e100));
  verb->add_option("--max-checks", options.max_checks,
                   "Planes tried for a query before it is called a collision (default: 1000)")
      ->check(between(0, 1000000000));
  CLI::Option* json =
      verb->add_option("--json", arguments->json,
                       "Write the answers to FILE; without FILE to stdout, instead of the lines")
          ->expected(0, 1)
          ->type_name("[FILE]");
  verb->footer(
      "Example: taut ccd queries.csv --type vf\n"
      "Prints INDEX,1,TIME for a collision and INDEX,0, for none; TIME, from 0 to 1, is never "
      "later than the first contact. Where a 7th "
      "column "
      "gives the true answers, they are compared. Exit code 1 when a collision was missed.");
  verb->callback([=, &exit_code] {
    arguments->wants_json = json->count() > 0;
    exit_code = ccd(*arguments);
  });
}

}  // namespace taut::app
