const search = document.getElementById("search");
const rows = [...document.querySelectorAll("#variables tr")].slice(1);
search.addEventListener("input", () => {
  const words = search.value.toLowerCase().split(" ");
  for (const row of rows) row.hidden = !words.every(word => row.textContent.toLowerCase().includes(word));
});
