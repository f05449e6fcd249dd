// Colors of the site, and its search for pages that are opened as files. There browsers do not start workers, so the search runs in the page and
// loads its index as a script.
"use strict";

if (location.protocol === "file:") {
  const load = (file) =>
    new Promise((done) => {
      const script = Object.assign(document.createElement("script"), { src: new URL(file, document.querySelector('script[src$="search/main.js"]').src), onload: done });
      document.head.append(script);
    });

  window.Worker = class {
    async postMessage({ init, query }) {
      if (init) {
        await Promise.all([load("lunr.js"), load("search_index.js")]);
        const { docs } = window.searchIndex;
        this.documents = new Map(docs.map((page) => [page.location, page]));
        this.index = lunr(function () {
          this.ref("location");
          for (const field of ["title", "text"]) this.field(field);
          for (const page of docs) this.add(page);
        });
        this.onmessage({ data: { config: window.searchIndex.config } });
        this.onmessage({ data: { allowSearch: true } });
      } else {
        const found = this.index.search(query).map(({ ref }) => this.documents.get(ref));
        this.onmessage({ data: { results: found.map((page) => ({ ...page, summary: page.text.slice(0, 200) })) } });
      }
    }
  };
}

// Dark colors where the browser prefers them. The theme's own script for this needs highlight.js, which the site does not have.
const prefersDark = matchMedia("(prefers-color-scheme: dark)");
const setColors = () => (document.documentElement.dataset.bsTheme = prefersDark.matches ? "dark" : "light");
prefersDark.addEventListener("change", setColors);
setColors();
