// What rows of contacts have in common, of a body's own and of those between bodies. gap(contact):
// [m] after the motions.
#pragma once

#include <algorithm>

#include "core/direct/constants.h"
#include "core/direct/constraint_set.h"
#include "core/direct/impulse_cache.h"
#include "core/direct/spring.h"

namespace ragdoll {

/// Rows of the contacts that are nearly closed after the motion, pressed in the last one, or are
/// active in any case. add(contact, its place, whether it is reached just now), the first row.
template <class Gap, class Add>
void addContactRows(ContactSet& set, const ImpulseCache& cache, const Gap& gap, const Add& add) {
  set.springs.assign(set.contacts.size(), {});
  set.row.assign(set.contacts.size(), -1);
  for (std::size_t i = 0; i < set.contacts.size(); ++i) {
    const Contact& c = set.contacts[i];
    if (set.role[i] == Role::kComing) continue;
    if (isOnlyNear(set.role[i]) && gap(c) > kClose && !cache.find(c)) continue;
    set.row[i] = add(c, static_cast<int>(i), isReached(set.role[i]));
  }
}

/// Rows of contacts that give way get their compliance, once A is assembled. Whether there are any.
template <class Rows>
bool softenContacts(ContactSet& set, Rows& rows, double h, bool leapfrog) {
  bool any = false;
  for (std::size_t i = 0; i < set.contacts.size(); ++i) {
    const int row = set.row[i];
    if (row < 0 || !set.contacts[i].isSoft()) continue;
    const double answer = rows.entry(row, row) - rows.row(row).compliance;
    set.springs[i] = springRow(set.contacts[i], h, answer, leapfrog);
    rows.soften(row, set.springs[i].compliance);
    any = true;
  }
  return any;
}

/// By how much a row is off: violated, and, closed, open while it presses. Left open it might not
/// count as touching where velocities are solved for, which would lack its half step of force.
inline double residual(double slack, double p, bool closed) {
  return closed && p > 0 ? std::abs(slack) : -slack;
}

/// [m] the worst of the rows that press with `total`.
template <class Gap>
double worstResidual(const ContactSet& set, const RowValues& total, const Gap& gap, bool closed) {
  double worst = 0;
  for (std::size_t i = 0; i < set.contacts.size(); ++i) {
    if (set.row[i] < 0) continue;
    const double p = total[set.row[i]];
    worst = std::max(worst, residual(set.springs[i].slack(gap(set.contacts[i]), p), p, closed));
  }
  return worst;
}

}  // namespace ragdoll
