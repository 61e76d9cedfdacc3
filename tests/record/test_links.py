"""Links in the folder of a run: what they point at is outside of it."""

import pytest

from doseki.cli.main import main


@pytest.mark.parametrize("command", ["report", "loads", "plot", "export"])
@pytest.mark.parametrize("name", ["loads.csv", "gauges/level.csv", "figures/zz.png", "trust.json"])
def test_no_link_in_the_folder_of_a_run_is_read(run_folder, tmp_path, capsys, command, name):
    (tmp_path / "outside").write_text("secret")
    link = run_folder / name
    link.parent.mkdir(exist_ok=True)
    link.unlink(missing_ok=True)
    link.symlink_to(tmp_path / "outside")
    with pytest.raises(SystemExit) as ended:
        main([command, str(run_folder), *(["--paraview"] if command == "export" else [])])
    assert ended.value.code == 2
    assert f"{link}: is a symbolic link; links in the" in capsys.readouterr().err
    assert not (run_folder / "report.html").exists()


def test_a_run_that_is_reached_over_a_link_is_read(run_folder, tmp_path, capsys):
    (tmp_path / "there").symlink_to(run_folder, target_is_directory=True)
    with pytest.raises(SystemExit) as ended:
        main(["report", str(tmp_path / "there")])
    assert ended.value.code == 0, capsys.readouterr().err
