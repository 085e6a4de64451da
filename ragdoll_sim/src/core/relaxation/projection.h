// Contacts by projection, for the relaxation: position-level Gauss-Seidel with accumulated
// multipliers.
//
// Normal: lambda_n <- max(0, lambda_n - gap / w). Friction acts against the tangential motion of
// the contact since the step's start, inside the disc |lambda_t| <= mu lambda_n (isotropic Coulomb
// cone, no pyramid). Restitution reflects the path beyond the contact and the velocity at its
// located time.
#pragma once

#include <vector>

#include "core/base/growing.h"
#include "core/contact/contact.h"
#include "core/mechanics/supports.h"
#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// A contact with what the sweeps need of it.
struct ProjectedContact {
  Contact contact;
  int begin = 0, end = 0;        ///< its entries in the response pool
  double w = 0;                  ///< [1/kg] c^T W c
  double inverse_w = 0;          ///< [kg]
  Vec3 held = Vec3::Zero();      ///< [m] where friction would keep the contact's point
  double lambda_n = 0;           ///< [kg m] accumulated
  Vec3 lambda_t = Vec3::Zero();  ///< [kg m], tangential
  double bounce_speed = 0;       ///< [m/s] normal velocity after the step; 0: no bounce
};

class ContactProjection {
 public:
  /// x0: start of the step; x1, v1: free motion (3 x N); h: [s].
  void prepare(const Model& model, const std::vector<Contact>& contacts, const Points& x0,
               const Points& x1, const Points& v1, double h);
  /// One sweep over all contacts; moves x.
  void sweep(Points& x);
  /// Gives bouncing contacts their speed, and the friction of the whole impact; changes v only.
  void bounce(double h, Points& v) const;
  void markPressed(Supports& supports) const;
  /// Adds the mean forces [N] of other bodies on the one with n columns from `first` on, in a step
  /// of h [s], to those of all (3 x N).
  void addPairForces(int first, int n, double h, Points& force) const;
  int pressing() const;  ///< contacts with lambda_n > 0

 private:
  struct Response {
    int column;
    double weight;  ///< [1/kg] column of W c
  };
  void addResponse(const Model& model, int ragdoll, const Contact& contact);
  /// Updates the multipliers at the contact's point; returns their change.
  Vec3 impulse(ProjectedContact& p, const Vec3& point) const;
  void apply(const ProjectedContact& p, const Vec3& impulse, Points& x) const;

  Roomy<ProjectedContact> contacts_;
  Roomy<Response, 2 * 16 * kRoomForRows> responses_;  ///< of two bodies, of 16 particles each
};

}  // namespace ragdoll
