#!/usr/bin/env python3
"""Lets go of a hand when the force on what holds it exceeds a limit [N]: rosrun ragdoll_sim stop_at_force.py 150

A second argument names the holder as ~wrenches does: attach_right_hand (the default), pin_right_hand of a
scene's pins, attach_ben_right_hand of another ragdoll than the first. Status 0: it has let go.
"""
import math
import re
import sys

import rospy
from geometry_msgs.msg import WrenchStamped
from ragdoll_msgs.msg import Model
from ragdoll_msgs.srv import Detach


def holders(model):
    """Body of each name that ~wrenches may have."""
    found = {}
    for number, ragdoll in enumerate(model.ragdolls):
        for particle in ragdoll.particles:
            name = particle if number == 0 else ragdoll.name + '_' + particle
            for kind in ('attach_', 'pin_'):
                found.setdefault(kind + re.sub('[^0-9A-Za-z_]', '_', name), ragdoll.name + '/' + particle)
    return found


def let_go_above(limit, holder):
    """What to end with: 0, or what went wrong."""
    rospy.wait_for_service('/ragdoll/detach')
    detach = rospy.ServiceProxy('/ragdoll/detach', Detach)
    bodies = holders(rospy.wait_for_message('/ragdoll/model', Model))
    if holder not in bodies:
        return "unknown holder '%s'; attach_ or pin_ and a particle would be right: %s ... %s" % (
            holder, list(bodies)[0], list(bodies)[-1])
    answers = []

    def feel(message):
        f = message.wrench.force
        force = (f.x ** 2 + f.y ** 2 + f.z ** 2) ** 0.5
        if force > limit and not answers:
            answers.append(detach(bodies[holder]))
            print('%.0f N: %s' % (force, answers[0].status_message))
            rospy.signal_shutdown('the force exceeds the limit')

    rospy.Subscriber('/ragdoll/wrenches/' + holder, WrenchStamped, feel)
    rospy.spin()
    if not answers:
        return 'ended before the force exceeded %g N' % limit
    return 0 if answers[0].success else 'it did not let go: ' + answers[0].status_message


def main():
    given = rospy.myargv()[1:]
    limit = float(given[0]) if given else 150.0
    if not 0 < limit < math.inf:
        return 'the limit is %g; it must be > 0 N' % limit
    rospy.init_node('stop_at_force')
    return let_go_above(limit, given[1] if len(given) > 1 else 'attach_right_hand')


if __name__ == '__main__':
    sys.exit(main())
