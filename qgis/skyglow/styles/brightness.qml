<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>
<qgis version="3.22.16-Białowieża" styleCategories="Symbology|Labeling">
  <pipe-data-defined-properties>
    <Option type="Map">
      <Option type="QString" value="" name="name"/>
      <Option name="properties"/>
      <Option type="QString" value="collection" name="type"/>
    </Option>
  </pipe-data-defined-properties>
  <pipe>
    <provider>
      <resampling enabled="false" zoomedInResamplingMethod="nearestNeighbour" maxOversampling="2" zoomedOutResamplingMethod="nearestNeighbour"/>
    </provider>
    <rasterrenderer opacity="0.85" band="1" type="singlebandpseudocolor" alphaBand="-1" classificationMax="0.00936162427773753" classificationMin="0" nodataColor="">
      <minMaxOrigin>
        <limits>None</limits>
        <extent>WholeRaster</extent>
        <statAccuracy>Estimated</statAccuracy>
        <cumulativeCutLower>0.02</cumulativeCutLower>
        <cumulativeCutUpper>0.98</cumulativeCutUpper>
        <stdDevFactor>2</stdDevFactor>
      </minMaxOrigin>
      <rastershader>
        <colorrampshader maximumValue="0.0093616242777375264" clip="0" colorRampType="DISCRETE" minimumValue="0" labelPrecision="6" classificationMode="1">
          <item color="#000000" value="2.28555280218201e-06" alpha="0" label="Artificial over natural light:"/>
          <item color="#0d0887" value="4.57110560436403e-06" alpha="255" label="1 % – 2 %"/>
          <item color="#3a049b" value="9.14221120872805e-06" alpha="255" label="2 % – 4 %"/>
          <item color="#5d01a6" value="1.82844224174561e-05" alpha="255" label="4 % – 8 %"/>
          <item color="#7e03a8" value="3.65688448349122e-05" alpha="255" label="8 % – 16 %"/>
          <item color="#9c179e" value="7.31376896698244e-05" alpha="255" label="16 % – 32 %"/>
          <item color="#b52f8c" value="0.000146275379339649" alpha="255" label="32 % – 64 %"/>
          <item color="#cb4778" value="0.000292550758679298" alpha="255" label="64 % – 1.3 ×"/>
          <item color="#dd6065" value="0.000585101517358595" alpha="255" label="1.3 × – 2.6 ×"/>
          <item color="#ed7953" value="0.00117020303471719" alpha="255" label="2.6 × – 5.1 ×"/>
          <item color="#f89541" value="0.00234040606943438" alpha="255" label="5.1 × – 10.2 ×"/>
          <item color="#feb32f" value="0.00468081213886876" alpha="255" label="10.2 × – 20.5 ×"/>
          <item color="#fbd524" value="0.00936162427773753" alpha="255" label="20.5 × – 41 ×"/>
          <item color="#f0f921" value="inf" alpha="255" label="above 41 ×"/>
          <rampLegendSettings minimumLabel="" orientation="2" useContinuousLegend="1" maximumLabel="" direction="0" suffix="" prefix="">
            <numericFormat id="basic">
              <Option type="Map">
                <Option type="QChar" value="" name="decimal_separator"/>
                <Option type="int" value="6" name="decimals"/>
                <Option type="int" value="0" name="rounding_type"/>
                <Option type="bool" value="false" name="show_plus"/>
                <Option type="bool" value="true" name="show_thousand_separator"/>
                <Option type="bool" value="false" name="show_trailing_zeros"/>
                <Option type="QChar" value="" name="thousand_separator"/>
              </Option>
            </numericFormat>
          </rampLegendSettings>
        </colorrampshader>
      </rastershader>
    </rasterrenderer>
    <brightnesscontrast contrast="0" brightness="0" gamma="1"/>
    <huesaturation grayscaleMode="0" invertColors="0" saturation="0" colorizeRed="255" colorizeOn="0" colorizeStrength="100" colorizeGreen="128" colorizeBlue="128"/>
    <rasterresampler maxOversampling="2"/>
    <resamplingStage>resamplingFilter</resamplingStage>
  </pipe>
  <blendMode>0</blendMode>
</qgis>
