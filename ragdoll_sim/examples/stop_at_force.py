#!/usr/bin/env python3
"""Lets go of a hand when the force on what holds it exceeds a limit [N]: rosrun ragdoll_sim stop_at_force.py 150"""
import sys

import rospy
from geometry_msgs.msg import WrenchStamped
from ragdoll_msgs.srv import Detach

limit = float(sys.argv[1]) if len(sys.argv) > 1 else 150.0
holder = sys.argv[2] if len(sys.argv) > 2 else 'attach_right_hand'  # pin_right_hand: of a scene's pins

rospy.init_node('stop_at_force')
rospy.wait_for_service('/ragdoll/detach')
detach = rospy.ServiceProxy('/ragdoll/detach', Detach)

while True:
    f = rospy.wait_for_message('/ragdoll/wrenches/' + holder, WrenchStamped).wrench.force
    force = (f.x ** 2 + f.y ** 2 + f.z ** 2) ** 0.5
    if force > limit:
        break
answer = detach(holder.split('_', 1)[1])
print('%.0f N: %s' % (force, answer.status_message))
