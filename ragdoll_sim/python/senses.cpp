#include "senses.h"

namespace ragdoll::python {
namespace {

/// One column of a structured array: its name, its shape, and its rows' values, flat.
class Table {
 public:
  explicit Table(std::size_t rows) : rows_(rows) {}

  void add(const char* name, const std::vector<std::string>& words) {
    fields_.append(py::make_tuple(name, "U64"));
    columns_.append(py::cast(words));
  }
  void add(const char* name, const std::vector<double>& numbers, int width = 1) {
    if (width == 1)
      fields_.append(py::make_tuple(name, "f8"));
    else
      fields_.append(py::make_tuple(name, "f8", py::make_tuple(width)));
    py::array_t<double> column(static_cast<py::ssize_t>(numbers.size()), numbers.data());
    columns_.append(width == 1 ? py::object(column)
                               : column.attr("reshape")(static_cast<py::ssize_t>(rows_), width));
  }

  py::object array() const {
    const py::module numpy = py::module::import("numpy");
    py::object all = numpy.attr("zeros")(rows_, fields_);
    for (std::size_t i = 0; i < columns_.size(); ++i)
      if (rows_ > 0) all[fields_[i].cast<py::tuple>()[0]] = columns_[i];
    return all;
  }

 private:
  std::size_t rows_;
  py::list fields_, columns_;
};

void append(const Vec3& v, std::vector<double>& to) { to.insert(to.end(), v.data(), v.data() + 3); }

}  // namespace

py::object contactArray(const Model& model, const ContactReport& report) {
  std::vector<std::string> ragdolls, bodies, others;
  std::vector<double> position, normal, depth, force, peak, impulse, slip;
  for (const Touch& touch : report.touches) {
    const ContactImpulse& c = touch.contact;
    std::string body;
    std::string other = otherName(model, c, &body);
    ragdolls.push_back(model.ragdolls[c.ragdoll].name);
    bodies.push_back(particlesName(model, c.ragdoll, c.particle));
    others.push_back(body.empty() ? other : other + "/" + body);
    append(c.point, position);
    append(c.normal, normal);
    append(report.interval > 0 ? Vec3(c.impulse / report.interval) : Vec3(Vec3::Zero()), force);
    depth.push_back(c.depth);
    peak.push_back(touch.peak_force);
    impulse.push_back(c.impulse.norm());
    slip.push_back(c.slip);
  }
  Table table(report.touches.size());
  table.add("ragdoll", ragdolls);
  table.add("body", bodies);
  table.add("other", others);
  table.add("position", position, 3);
  table.add("normal", normal, 3);
  table.add("depth", depth);
  table.add("force", force, 3);
  table.add("peak_force", peak);
  table.add("impulse", impulse);
  table.add("slip", slip);
  return table.array();
}

py::object imuArray(const Model& model, const std::vector<ImuSample>& samples) {
  std::vector<std::string> sensors;
  std::vector<double> time, acceleration, turn, orientation;
  for (const ImuSample& sample : samples) {
    time.push_back(static_cast<double>(sample.step) * model.solver.step);
    sensors.push_back(model.sensors[sample.sensor].name);
    append(sample.acceleration, acceleration);
    append(sample.angular_velocity, turn);
    const auto& q = sample.pose.orientation.coeffs();
    orientation.insert(orientation.end(), q.data(), q.data() + 4);
  }
  Table table(samples.size());
  table.add("time", time);
  table.add("sensor", sensors);
  table.add("acceleration", acceleration, 3);
  table.add("angular_velocity", turn, 3);
  table.add("orientation", orientation, 4);
  return table.array();
}

}  // namespace ragdoll::python
