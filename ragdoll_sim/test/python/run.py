#!/usr/bin/python3
"""Runs the unittests of a file and writes a JUnit result: run.py TEST.py RESULT.xml [TEST...]"""

import importlib.util
import os
import sys
import unittest
from xml.sax.saxutils import quoteattr


class Result(unittest.TextTestResult):
    def startTestRun(self):
        self.cases = []

    def stopTest(self, test):
        super().stopTest(test)
        bad = [text for case, text in self.failures + self.errors
               if case is test or getattr(case, 'test_case', None) is test]
        skipped = any(case is test for case, _ in self.skipped)
        self.cases.append((test.id(), '\n'.join(bad), skipped))


def write(path, name, result):
    cases = list(result.cases)
    cases += [(case.id(), text, False) for case, text in result.errors
              if not isinstance(case, unittest.TestCase)]  # of setUpClass
    os.makedirs(os.path.dirname(path) or '.', exist_ok=True)
    with open(path, 'w') as out:
        out.write('<testsuite name=%s tests="%d">\n' % (quoteattr(name), len(cases)))
        for case, text, skipped in cases:
            head, _, tail = case.rpartition('.')
            inside = '<skipped/>' if skipped else '<failure message=%s/>' % quoteattr(text) if text else ''
            out.write('<testcase classname=%s name=%s>%s</testcase>\n' % (
                quoteattr(head), quoteattr(tail), inside))
        out.write('</testsuite>\n')


def main():
    path, result_path, names = sys.argv[1], sys.argv[2], sys.argv[3:]
    name = os.path.splitext(os.path.basename(path))[0]
    sys.path.insert(0, os.path.dirname(os.path.abspath(path)))
    spec = importlib.util.spec_from_file_location(name, path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    loader = unittest.TestLoader()
    suite = loader.loadTestsFromNames(names, module) if names else loader.loadTestsFromModule(module)
    result = unittest.TextTestRunner(resultclass=Result, verbosity=2).run(suite)
    write(result_path, name, result)
    sys.exit(not result.wasSuccessful())


if __name__ == '__main__':
    main()
