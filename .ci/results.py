"""Counts the test cases of a test run: results.py BUILD_DIR... [--filtered].

Every case in the XML results counts. A test program that crashed, hung, was not found, or left no
result counts as one failure, and so does each report of a sanitizer.
"""
import glob
import os
import re
import sys
import xml.etree.ElementTree as ElementTree


def cases(path):
    """(name, 'passed' | 'failed' | 'skipped', message) for every case in a result file."""
    file = os.path.basename(path)[: -len('.xml')]
    try:
        tree = ElementTree.parse(path)
    except ElementTree.ParseError as error:
        # A rostest node that was killed leaves an empty file; missing_nodes() tells.
        if not file.startswith('rosunit-'):
            yield file, 'failed', 'not a result file: %s' % error
        return
    for case in tree.iter('testcase'):
        name = '%s: %s.%s' % (file, case.get('classname'), case.get('name'))
        bad = [e for e in case if e.tag in ('failure', 'error')]
        if bad:
            yield name, 'failed', '\n'.join(e.text or e.get('message') or '' for e in bad)
        elif case.find('skipped') is not None or case.get('status') == 'notrun':
            yield name, 'skipped', ''
        else:
            yield name, 'passed', ''


def read_results(folder):
    results = []
    for path in sorted(glob.glob(os.path.join(folder, '*', '*.xml'))):
        found = list(cases(path))
        # rostest's own file only says whether a test node ran; the node's cases are in rosunit-*.
        if os.path.basename(path).startswith('rostest-'):
            found = [case for case in found if case[1] == 'failed']
        results += found
    return results


def failed_programs(build, results):
    """Programs that ctest saw fail while no result file says why."""
    failures = ''.join(name.split(':')[0] + '\n' for name, what, _ in results if what == 'failed')
    log = os.path.join(build, 'Testing', 'Temporary', 'LastTestsFailed.log')
    lines = open(log).read().split() if os.path.exists(log) else []
    for program in (line.split(':', 1)[1] for line in lines):
        match = re.match(r'_ctest_[a-z_]*?_(gtest|rostest)_(.*?)(\.test)?$', program)
        file = '%s-%s' % match.group(1, 2) if match else program
        # A rostest fails with its nodes' cases, whose file is named after the node.
        if file not in failures and not ('rosunit-' in failures and file.startswith('rostest-')):
            yield program, 'failed', 'failed without a result: crashed or hung'


def missing_nodes(build, results):
    """Test nodes of rostest files that left no result, or share a name and so overwrite theirs."""
    root = os.path.dirname(build)
    seen = {}
    for path in sorted(glob.glob(os.path.join(root, '*', 'test', 'ros', '*.test'))):
        package = os.path.relpath(path, root).split(os.sep)[0]
        if not os.path.isdir(os.path.join(build, package)):
            continue  # ragdoll_rviz is not built everywhere
        for name in re.findall(r'test-name="([^"]*)"', open(path).read()):
            where = os.path.relpath(path, root)
            if name in seen:
                yield where, 'failed', 'test-name "%s" is already used in %s' % (name, seen[name])
            seen[name] = where
            if not any(result.startswith('rosunit-%s:' % name) or result.endswith('.test' + name)
                       for result, _, _ in results):
                yield where, 'failed', 'test node "%s" left no result' % name


def sanitizer_reports(build):
    """What the sanitizers found, one file for each process."""
    for path in sorted(glob.glob(os.path.join(build, 'reports', '*'))):
        text = open(path, errors='replace').read()
        yield os.path.relpath(path, os.path.dirname(build)), 'failed', text[:4000]


def results_of(build, filtered):
    results = read_results(os.path.join(build, 'test_results'))
    results += list(failed_programs(build, results))
    if not filtered:
        results += list(missing_nodes(build, results))
    results += list(sanitizer_reports(build))
    return results or [('%s: no test has run' % os.path.basename(build), 'failed', '')]


def run_again(build):
    """Names of rostests that failed beside others, so that ./test ran them a second time."""
    path = os.path.join(build, 'Testing', 'again.txt')
    return open(path).read().split() if os.path.exists(path) else []


def main():
    filtered = '--filtered' in sys.argv
    builds = [argument for argument in sys.argv[1:] if argument != '--filtered']
    results = [result for build in builds for result in results_of(build, filtered)]

    print()
    for name, what, message in results:
        if what == 'failed':
            print('FAILED %s\n%s' % (name, re.sub('(?m)^', '    ', message.strip())))
        elif what == 'skipped':
            print('skipped %s' % name)
    for name in (name for build in builds for name in run_again(build)):
        print('run a second time, since it failed beside others: %s' % name)
    count = [what for _, what, _ in results].count
    print('%d passed, %d failed' % (count('passed'), count('failed')))
    return 1 if count('failed') else 0


if __name__ == '__main__':
    sys.exit(main())
