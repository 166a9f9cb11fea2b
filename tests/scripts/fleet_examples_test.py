"""What examples/fleet and the pages about it hold, as far as it can be checked without a cluster: it parses, has the keys that
its engine asks for, and it is short. tests/cli/scenario_slurm.py runs what can run."""

import pathlib
import re
import subprocess
import tempfile
import unittest

import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples/fleet"
PAGE = ROOT / "docs/howto/fleet.md"


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
        self.assertIn(f"-j {container['resources']['requests']['cpu']} ", container["command"][2])
        self.assertEqual({mount["name"] for mount in container["volumeMounts"]}, {volume["name"] for volume in pod["volumes"]})

    def test_commands_of_the_page_and_of_slurm_are_sound_shell(self):
        with tempfile.TemporaryDirectory() as folder:
            scripts = [EXAMPLES / "slurm.sh"]
            for number, block in enumerate(blocks(PAGE, "sh")):
                scripts.append(pathlib.Path(folder) / f"{number}.sh")
                scripts[-1].write_text("#!/bin/bash\n" + block)
            for script in scripts:
                done = subprocess.run(["shellcheck", script], capture_output=True, text=True, check=False)
                self.assertEqual(done.returncode, 0, done.stdout)


if __name__ == "__main__":
    unittest.main()
