// Which springs press where a stick and the particles at its ends give way on one obstacle.
#pragma once

#include <vector>

#include "core/contact/contact.h"

namespace ragdoll {

/// Takes out of the springs of particles what the sticks have of them that press between their
/// ends: of the contacts from `begin` on, all with one obstacle.
void shareSprings(const Model& model, const Obstacle& obstacle, const Ragdoll& ragdoll,
                  std::size_t begin, std::vector<Contact>& contacts);

/// On what is round a stick has springs at its deepest place and at its shallower end, so that none
/// comes or goes as the place moves onto the deeper end. Takes that end's out, of the contacts from
/// `begin` on, all with one obstacle.
void dropDeeperEnds(std::size_t begin, std::vector<Contact>& contacts);

}  // namespace ragdoll
