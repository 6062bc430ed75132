// [contact] and [[contact.pair]].

#include <fmt/format.h>

#include <algorithm>

#include "taut/sim/describe.h"

namespace taut {

namespace {

void describe_pair(SchemaVisitor& v, ContactPair& pair) {
  v.text("cloth", pair.cloth, {.doc = "name of a cloth", .required = true});
  v.text("with", pair.with,
         {.doc = "name of a cloth or solid; the same cloth: its own layers", .required = true});
  v.number("thickness", pair.thickness,
           {.doc = "they keep this far apart: two cloths middle to middle, a cloth from a solid's "
                   "surface; when not given: as without the pair",
            .unit = "m",
            .min = 0,
            .max = 1,
            .unset = pair.thickness < 0.0});
  v.number("friction", pair.friction,
           {.doc = "Coulomb's μ; when not given: as without the pair",
            .min = 0,
            .max = 100,
            .unset = pair.friction < 0.0});
}

bool has_name(std::span<const std::string> names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

bool same_bodies(const ContactPair& a, const ContactPair& b) {
  return (a.cloth == b.cloth && a.with == b.with) || (a.cloth == b.with && a.with == b.cloth);
}

}  // namespace

void describe_contact(SchemaVisitor& v, ContactOptions& contact) {
  v.integer(
      "max_passes", contact.max_passes,
      {.doc =
           "solves per step, at most, until the contacts and their stick or slide no longer change",
       .min = 1,
       .max = 1000});
  v.number("touch_tolerance", contact.touch_tolerance,
           {.doc = "a node this close to a solid's thickened surface touches it",
            .unit = "m",
            .min = 0,
            .max = 0.1});
  v.flag("self", contact.self,
         {.doc = "keeps cloth from passing through itself, other cloths and mesh solids"});
  v.number("thickness", contact.thickness,
           {.doc = "layers of cloth keep this far apart, middle to middle; 0: a tenth of the mean "
                   "edge, at most 1 mm",
            .unit = "m",
            .min = 0,
            .max = 1});
  v.number("friction", contact.friction,
           {.doc = "Coulomb's μ of cloth on cloth", .min = 0, .max = 100});
  v.integer(
      "sweeps", contact.sweeps,
      {.doc =
           "rounds of impulses, at most, before nodes that still collide are held as rigid zones",
       .min = 0,
       .max = 1000});
  v.integer("check_every", contact.check_every,
            {.doc = "steps from one exact check for intersections (stats.csv) to the next; 0: none",
             .min = 0,
             .max = 1e6});
  v.flag("allow_intersections", contact.allow_intersections,
         {.doc = "starts although the cloths intersect; what has passed through then may stay so"});
  v.flag("untangle", contact.untangle,
         {.doc = "cloth that intersects at the start, or is inside a solid, is drawn apart before "
                 "the first step, as `--untangle` does; "
                 "pinned nodes stay"});
  v.list("pair", contact.pairs, {.doc = "Another thickness or friction for two of the bodies."},
         [&](ContactPair& pair) { describe_pair(v, pair); });
}

void check_pairs(SchemaVisitor& v, std::span<const ContactPair> pairs,
                 std::span<const std::string> cloths, std::span<const std::string> solids) {
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const ContactPair& pair = pairs[k];
    const auto complain = [&](bool holds, const std::string& what) {
      v.check(holds, "contact", fmt::format("contact.pair number {} (from 0): {}", k, what));
    };
    const bool with_cloth = has_name(cloths, pair.with);
    complain(has_name(cloths, pair.cloth), fmt::format("there is no cloth named '{}'", pair.cloth));
    complain(with_cloth || has_name(solids, pair.with),
             fmt::format("there is no cloth or solid named '{}'", pair.with));
    complain(pair.thickness >= 0.0 || pair.friction >= 0.0, "give a thickness, a friction or both");
    complain(!with_cloth || pair.thickness != 0.0,
             "two cloths cannot be 0 apart: give a thickness above 0");
    for (std::size_t j = 0; j < k; ++j)
      complain(!same_bodies(pairs[j], pair),
               fmt::format("number {} is of the same two: keep one of them", j));
  }
}

void check_names(SchemaVisitor& v, const char* key, std::span<const std::string> names) {
  for (std::size_t i = 0; i < names.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      v.check(names[i] != names[j], key,
              fmt::format("two entries are named '{}' (numbers {} and {}, from 0): give each its "
                          "own name",
                          names[i], j, i));
}

}  // namespace taut
