// One limit from the values of its directions, for who knows them already. Private to the core.
#pragma once

#include "ragdoll_sim/core/limits.h"

namespace ragdoll {

/// [rad] C of a limit whose reference and child are r and w; x: coordinates of the body's first
/// particle.
double limitValue(const Limit& limit, const Vec3& r, const Vec3& w, const double* x);

/// Its value and gradient into a row; first: the body's first column of the state.
void evaluateLimit(const Limit& limit, const Vec3& r, const Vec3& w, const double* x, int first,
                   LimitRow& row);

/// [rad] C; border: as LimitRow::border.
double limitAtBorder(const Limit& limit, const double* x, int border);

/// Which border of a wedge C at x is the angle to, as LimitRow::border; 0: its tip, or no wedge.
int nearerBorder(const Limit& limit, const double* x);

/// How far, as a sine, a child is from leaving a wedge's border, over the tip or through the middle
/// of the wedge to the other one, as what gives way may; < 0: it has.
double roomAtBorder(const Limit& limit, const double* x, int border);

/// Whether the child of a kWedge points along the axis, to rounding: there C has no gradient.
bool isAtTip(const Limit& limit, const double* x);

/// Value and gradient of a motion from x that a moment later is at `ahead`: of row.border, or the
/// border that is nearer there (then row.border), as if it went on; where the motion leads from the
/// tip into the open, with the gradient there.
void evaluateLimit(const Limit& limit, const double* x, const double* ahead, int first,
                   LimitRow& row);

}  // namespace ragdoll
