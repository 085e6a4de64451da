"""docs/ros_api.md as the tests read it, and what a running node has."""

import os
import re

import rosgraph
import roslib.packages

NODE = '/ragdoll'
PAGE = os.path.join(roslib.packages.get_pkg_dir('ragdoll'), 'docs', 'ros_api.md')


def rows():
    """(heading, cells) of each row of each table."""
    heading = ''
    with open(PAGE) as page:
        for line in page:
            if line.startswith('#'):
                heading = line.strip('# \n')
            if line.startswith('|'):
                yield heading, [cell.strip() for cell in line.strip().strip('|').split('|')]


def names(cell, node):
    """The topics, services or parameters that a cell names, as the node has them."""
    return [name.replace('~', node + '/') for name in re.findall(r'`([~/][^`]*)`', cell)]


def column(heading, index=1):
    """{name: cell} of a table whose first column has names."""
    return {name: cells[index] for where, cells in rows() if where == heading
            for name in names(cells[0], NODE)}


def table(heading, node):
    """{first cell: names in the second} of a table."""
    return {cells[0]: set(names(cells[1], node)) for where, cells in rows()
            if where == heading and len(cells) == 2}


def of_node(node):
    """The topics that it publishes, and those that it subscribes to."""
    state = rosgraph.Master('/page').getSystemState()
    return [{topic for topic, nodes in kind if node in nodes} for kind in state[:2]]
