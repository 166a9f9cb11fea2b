"""What examples/fleet and the pages about it hold, as far as it can be checked without a cluster: it parses, has the keys that
its engine asks for, and its commands are those of the contract. tests/cli/scenario_fleet_engines.py runs what can run."""

import json
import pathlib
import re
import subprocess
import tempfile
import unittest

import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples/fleet"
PAGES = (ROOT / "docs/howto/fleet-slurm.md", ROOT / "docs/howto/fleet-elsewhere.md")
RUN = ["fleet", "run", "/atlas", "--shard", "auto", "-j", "4", "--quiet"]


def blocks(page, language):
    return re.findall(rf"^```{language}\n(.*?)^```$", page.read_text(), re.DOTALL | re.MULTILINE)


class FleetExamples(unittest.TestCase):
    def test_kubernetes_job_is_indexed_and_runs_the_shard_that_it_is_told(self):
        job = yaml.safe_load((EXAMPLES / "kubernetes.yaml").read_text())
        self.assertEqual((job["apiVersion"], job["kind"]), ("batch/v1", "Job"))
        self.assertEqual(job["spec"]["completionMode"], "Indexed")
        self.assertGreater(job["spec"]["completions"], job["spec"]["parallelism"])
        pod = job["spec"]["template"]["spec"]
        self.assertIn(pod["restartPolicy"], ("Never", "OnFailure"))
        container, = pod["containers"]
        self.assertEqual(container["args"], RUN)
        self.assertEqual(container["resources"]["requests"]["cpu"], RUN[RUN.index("-j") + 1])
        self.assertEqual({mount["name"] for mount in container["volumeMounts"]}, {volume["name"] for volume in pod["volumes"]})

    def test_aws_batch_definition_runs_the_shard_that_it_is_told(self):
        definition = json.loads((EXAMPLES / "aws-batch.json").read_text())
        container = definition["containerProperties"]
        self.assertEqual(definition["type"], "container")
        self.assertEqual(container["command"], RUN)
        wanted = {one["type"]: one["value"] for one in container["resourceRequirements"]}
        self.assertEqual(wanted["VCPU"], RUN[RUN.index("-j") + 1])
        self.assertEqual([mount["sourceVolume"] for mount in container["mountPoints"]],
                         [volume["name"] for volume in container["volumes"]])

    def test_containerfile_is_short_and_takes_the_bundle(self):
        lines = (ROOT / "examples/container/Containerfile").read_text().splitlines()
        self.assertLessEqual(len(lines), 12)
        words = {line.split()[0] for line in lines if not line.startswith("#")}
        self.assertLessEqual(words, {"FROM", "RUN", "ADD", "ENV", "USER", "WORKDIR", "ENTRYPOINT", "CMD"})
        added, = [line.split()[1] for line in lines if line.startswith("ADD")]
        self.assertEqual(added, "gdtslam-*-linux-x86_64.tar.gz")
        self.assertIn('"${CMAKE_SYSTEM_NAME}-${CMAKE_SYSTEM_PROCESSOR}" platform)\nset(GDTSLAM_BUNDLE_NAME gdtslam-${PROJECT_VERSION}-${platform})',
                      (ROOT / "cmake/GdtslamBundle.cmake").read_text())

    def test_snakefile_is_short(self):
        self.assertLessEqual(len((EXAMPLES / "Snakefile").read_text().splitlines()), 25)

    def test_pages_show_the_files_that_are_there(self):
        for page in PAGES:
            for link in re.findall(r"\]\(([^)#]+)", page.read_text()):
                if "://" not in link:
                    self.assertTrue((page.parent / link).exists(), f"{page.name}: {link}")

    def test_commands_of_the_pages_are_sound_shell(self):
        with tempfile.TemporaryDirectory() as folder:
            for page in PAGES:
                for number, block in enumerate(blocks(page, "sh")):
                    script = pathlib.Path(folder) / f"{page.stem}-{number}.sh"
                    script.write_text("#!/bin/bash\n" + block)
                    subprocess.run(["bash", "-n", script], check=True)
                    # SC2012: ls of names that a person chose; SC2016: the '{}' and '$1' that another program fills in.
                    done = subprocess.run(["shellcheck", "--exclude=SC2012,SC2016,SC2086", script], capture_output=True, text=True, check=False)
                    self.assertEqual(done.returncode, 0, done.stdout)


if __name__ == "__main__":
    unittest.main()
