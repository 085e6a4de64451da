#!/usr/bin/python3
"""What a release says of itself agrees: versions, and the commands of README, Dockerfile and workflow."""

import json
import os
import pathlib
import re
import shutil
import subprocess
import unittest

import yaml

ROOT = pathlib.Path(__file__).resolve().parents[3]
PACKAGES = [ROOT, ROOT / 'ragdoll_msgs', ROOT / 'ragdoll_sim', ROOT / 'ragdoll_rviz']


def text(name):
    return (ROOT / name).read_text()


def version(package):
    return re.search('<version>(.*)</version>', (package / 'package.xml').read_text()).group(1)


def dockerfile(word):
    """What follows the word on its lines."""
    return re.findall('(?m)^%s (.*)$' % word, text('Dockerfile'))


def steps(job):
    found = yaml.safe_load(text('.github/workflows/test.yml'))['jobs'][job]['steps']
    return [step['run'] for step in found if 'run' in step]


class Release(unittest.TestCase):
    def test_packages_changelogs_and_citation_have_one_version(self):
        citation = yaml.safe_load(text('CITATION.cff'))
        for package in PACKAGES:
            self.assertEqual(version(package), citation['version'], package)
            released = re.findall(r'(?m)^(\d+\.\d+\.\d+) \((\d{4}-\d\d-\d\d)\)$',
                                  (package / 'CHANGELOG.rst').read_text())
            self.assertEqual(released[0], (citation['version'], str(citation['date-released'])))

    def test_every_source_that_is_cited_has_what_the_format_asks_for(self):
        for source in yaml.safe_load(text('CITATION.cff'))['references']:
            self.assertLessEqual({'type', 'title', 'authors', 'year'}, set(source), source)

    @unittest.skipUnless(shutil.which('catkin_lint'), 'catkin_lint is not installed')
    def test_catkin_lint_finds_nothing(self):
        lint = subprocess.run(['catkin_lint', '--offline', '-W1', *map(str, PACKAGES)],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              universal_newlines=True)
        self.assertIn('found 0 problems', lint.stdout)


class Commands(unittest.TestCase):
    """README, Dockerfile and workflow run the same ones."""

    def test_the_two_commands(self):
        start = re.search(r'## Start.*?```\n(.*?)```', text('README.md'), re.S).group(1)
        self.assertEqual([line.split()[0] for line in start.splitlines()], ['./run', './test'])
        self.assertEqual(dockerfile('RUN'), ['./run --setup'])
        self.assertEqual(steps('test'), ['./run --setup', './test'])

    def test_one_system(self):
        self.assertEqual(dockerfile('FROM'), ['debian:12'])
        job = yaml.safe_load(text('.github/workflows/test.yml'))['jobs']['test']
        self.assertEqual(job['container'], 'debian:12')
        self.assertIn('On Debian 12', text('README.md'))

    def test_the_image(self):
        build, run = re.search(r'```\n(docker build .*)\n(docker run .*)\n```', text('README.md')).groups()
        self.assertIn('#   %s\n#   %s\n' % (build, run), text('Dockerfile'))
        demo = ' '.join(json.loads(dockerfile('CMD')[0]))
        in_workflow = '%s timeout --signal=INT 20 %s || test $? = 124' % (run.replace(' -it', ''), demo)
        self.assertEqual(steps('image')[:2], [build, in_workflow])

    def test_the_launch_file_has_the_arguments(self):
        launch = text('launch/ragdoll.launch')
        for argument in json.loads(dockerfile('CMD')[0])[1:]:
            self.assertIn('<arg name="%s"' % argument.split(':=')[0], launch)

    @unittest.skipUnless(shutil.which('roslaunch'), 'roslaunch is not installed')
    def test_the_bag_is_where_it_is_asked_for(self):
        for bag, path in (('/bags/fall.bag', '/bags/fall.bag'), ('fall.bag', str(ROOT) + '/fall.bag')):
            command = subprocess.run(
                ['roslaunch', '--args', '/record', 'launch/ragdoll.launch', 'rviz:=false', 'bag:=' + bag],
                cwd=ROOT, env=dict(os.environ, PWD=str(ROOT)), stdout=subprocess.PIPE,
                universal_newlines=True).stdout
            self.assertIn(' -O %s /tf ragdoll/state' % path, command)


if __name__ == '__main__':
    unittest.main()
