"""What the site has besides the pages of docs/: navigation, the formulas' typesetter, and links out of the folder."""

import os
import re
from pathlib import Path

from mkdocs.structure.files import File

HERE = Path(__file__).parent
ROOT = HERE.parent
KATEX = HERE / "node_modules/katex/dist"
# Where the source files of the project can be seen, if that is anywhere: links to them are text elsewhere.
SOURCES = os.environ.get("STERADIAN_SOURCES", "").rstrip("/")
LINK = re.compile(r"(?<!!)\[([^\]]*)\]\(([^)\s]+)\)")


def on_config(config):
    config.nav = [
        {"Course": course()},
        {"Documentation": ["README.md", *sections()]},
    ]
    return config


def course():
    folder = ROOT / "docs/course"
    return [f"course/{page.name}" for page in [folder / "README.md", *sorted(folder.glob("[0-9s]*.md"))] if page.exists()]


def sections():
    """The sections of docs/README.md, each with the pages that it links to first."""
    parts, seen = [], {"README.md"}
    for line in (ROOT / "docs/README.md").read_text().splitlines():
        if line.startswith("## "):
            parts.append((line[3:], []))
        for target in re.findall(r"\]\(([\w./-]+\.md)\)", line):
            if parts and target not in seen and not target.startswith("..") and not target.startswith("course/"):
                seen.add(target)
                parts[-1][1].append(target)
    return [{title: pages} for title, pages in parts if pages]


def on_files(files, config):
    for name in ["katex.min.js", "katex.min.css", *(f"fonts/{f.name}" for f in (KATEX / "fonts").glob("*.woff2"))]:
        files.append(File.generated(config, f"assets/katex/{name}", abs_src_path=str(KATEX / name)))
    for name in ["pages.js", "site.css"]:
        files.append(File.generated(config, f"assets/{name}", abs_src_path=str(HERE / "theme" / name)))
    return files


def on_page_markdown(markdown, page, config, files):
    folder = (ROOT / "docs" / page.file.src_uri).parent

    def target(match):
        text, link = match.groups()
        path, _, anchor = link.partition("#")
        if re.match(r"[a-z]+:", link) or not path:
            return match[0]
        file = (folder / path).resolve()
        if not file.exists():
            raise SystemExit(f"{page.file.src_uri}: the link {link} leads nowhere")
        if file.is_dir() and (file / "README.md").exists() and file.is_relative_to(ROOT / "docs"):
            return f"[{text}]({path.rstrip('/')}/README.md)"
        if file.is_file() and file.is_relative_to(ROOT / "docs"):
            return match[0]
        # A file of the project that is no page.
        return f"[{text}]({SOURCES}/{file.relative_to(ROOT)})" if SOURCES else text
    # Code has no links.
    parts = re.split(r"(^```.*?^```)", markdown, flags=re.M | re.S)
    return "".join(part if i % 2 else LINK.sub(target, part) for i, part in enumerate(parts))
